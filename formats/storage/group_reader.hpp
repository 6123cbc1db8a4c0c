// SPDX-License-Identifier: MIT
// Guarded access to the groups, attributes and datasets of an opened asset. Hard links
// only, and no object is opened that is_sound_object refuses.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "formats/core/result.hpp"
#include "formats/storage/byte_device.hpp"
#include "formats/storage/dataset_reader.hpp"
#include "formats/storage/hdf5_session.hpp"
#include "formats/storage/object_header.hpp"

namespace souple::storage {

class GroupReader {
 public:
  /// `where` names the file in issues; `device` outlives the reader.
  static Result<GroupReader> root(hid_t file, ByteDevice& device, std::string where);

  const std::string& where() const { return where_; }
  Result<bool> has(const std::string& name) const;
  Result<GroupReader> group(const std::string& name) const;  ///< asset_missing_part, asset_corrupt
  Result<DatasetReader> dataset(const std::string& name) const;
  /// Ascending (by bytes), at most `limit`; refuses links that are not hard.
  Result<std::vector<std::string>> child_names(std::size_t limit) const;

  Result<std::string> text(const char* attribute) const;  ///< valid text, at most limits::text_bytes
  Result<double> real(const char* attribute) const;       ///< finite
  /// `otherwise` where there is no such attribute.
  Result<double> real_or(const char* attribute, double otherwise) const;
  Result<std::int64_t> integer(const char* attribute) const;
  Result<std::int64_t> integer_or(const char* attribute, std::int64_t otherwise) const;
  Result<bool> has_attribute(const char* attribute) const;

 private:
  GroupReader(Handle id, ByteDevice& device, std::string where)
      : id_(std::move(id)), device_(&device), where_(std::move(where)) {}
  Status check_link(const std::string& name, ObjectKind kind) const;
  Result<Handle> scalar_attribute(const char* attribute) const;
  Issue damaged(const std::string& what) const;

  Handle id_;
  ByteDevice* device_;
  std::string where_;
};

/// Reads a whole dataset of rows; its rank, type and width must be those of Row.
template <class Row>
Result<std::vector<Row>> read_rows(const GroupReader& group, const std::string& name,
                                   std::uint64_t row_limit) {
  Result<DatasetReader> dataset = group.dataset(name);
  if (!dataset) return dataset.issue();
  if (Status status = dataset->expect(row_type(static_cast<const Row*>(nullptr))); !status)
    return status.issue();
  return dataset->read_all<Row>(row_limit);
}

}  // namespace souple::storage
