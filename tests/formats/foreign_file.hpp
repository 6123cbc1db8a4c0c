// SPDX-License-Identifier: MIT
// Assets that HDF5 itself changed: sound HDF5, but not what the writer writes.
#pragma once
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "formats/core/issue.hpp"
#include "sample_asset.hpp"

namespace souple::test {

inline constexpr H5Z_filter_t zstd = 32015;

constexpr int number(IssueCode code) { return static_cast<int>(code); }

class ForeignFile : public ::testing::Test {
 protected:
  void SetUp() override;
  /// Lets HDF5 change the asset on disk.
  void change(const std::function<void(hid_t)>& edit);
  /// The first issue's code, 0 if there is none.
  int code() const;

  ScratchFolder scratch_;
  std::string file_ = scratch_.path("a.souple");
  Asset asset_ = make_sample_asset();
};

void set_integer(hid_t file, const char* group, const char* name, std::int64_t value);
void set_text(hid_t file, const char* group, const char* name, const std::string& value);
/// Puts `value` in the place of one scalar of a dataset.
void set_scalar(hid_t file, const char* path, std::size_t scalar, double value);

/// What a replaced dataset is made of; the defaults are what the reader asks for.
struct DatasetShape {
  std::vector<hsize_t> extent;
  std::vector<hsize_t> chunk;
  hid_t type = H5T_STD_I32LE;
  std::vector<H5Z_filter_t> filters{H5Z_FILTER_SHUFFLE, zstd, H5Z_FILTER_FLETCHER32};
  bool growing = false;
};

/// Puts an empty dataset in the place of `path`; the caller closes it.
hid_t replace_dataset(hid_t file, const char* path, const DatasetShape& shape);

}  // namespace souple::test
