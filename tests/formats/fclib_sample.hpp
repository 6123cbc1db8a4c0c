// SPDX-License-Identifier: MIT
// Files in FCLIB's layout written list by list with HDF5 itself, so that any list can be wrong.
#pragma once
#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace souple::test {

/// Lists by their path; a list may be left out, be of any length and hold anything.
struct RawFclib {
  std::map<std::string, std::vector<int>> integers;
  std::map<std::string, std::vector<double>> reals;
  std::map<std::string, std::string> texts;

  std::vector<std::byte> bytes() const;
};

/// Two contacts that W couples, in triplets.
RawFclib sample_fclib();

}  // namespace souple::test
