// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "formats/core/result.hpp"
#include "formats/storage/hdf5_session.hpp"

namespace souple::fclib {

/// Access to groups and lists of an HDF5 file of any version. Hard links only; no external or virtual
/// data, no filters but deflate, shuffle and checksums; a list's claimed size has to be borne out by
/// the bytes it stores before memory is taken. Issues: contact_file_damaged, contact_problem_too_large.
class GuardedGroup {
 public:
  /// `where` names the file in issues, `file_bytes` bounds what a list may claim to store.
  static Result<GuardedGroup> root(hid_t file, std::uint64_t file_bytes, std::string where);

  const std::string& where() const { return where_; }
  bool has(const char* name) const;  ///< by a hard link
  Result<GuardedGroup> group(const std::string& name) const;
  Result<std::int64_t> integer(const char* name) const;  ///< a list of one
  Result<std::vector<std::int64_t>> integers(const char* name) const;
  Result<std::vector<double>> reals(const char* name) const;
  /// Printable ASCII of at most 64 KiB; what is not becomes '?'. Empty if it is not there.
  std::string text(const char* name) const;

 private:
  GuardedGroup(storage::Handle id, std::uint64_t file_bytes, std::string where)
      : id_(std::move(id)), file_bytes_(file_bytes), where_(std::move(where)) {}
  Issue damaged(const std::string& name, const std::string& what) const;
  Result<storage::Handle> dataset(const std::string& name, H5T_class_t kind) const;
  Result<std::size_t> length(hid_t dataset, const std::string& name, std::size_t value_bytes) const;

  storage::Handle id_;
  std::uint64_t file_bytes_ = 0;
  std::string where_;
};

}  // namespace souple::fclib
