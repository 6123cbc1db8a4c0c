// SPDX-License-Identifier: MIT
// Creates groups, attributes and datasets. The first call of HDF5 that fails is remembered by the
// shared WriteProgress; what comes after it does nothing.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/storage/hdf5_session.hpp"
#include "formats/storage/row_type.hpp"

namespace souple::storage {

struct WriteProgress {
  int zstd_level;
  bool ok = true;
};

class GroupWriter {
 public:
  /// Borrows `progress`, which outlives every writer.
  GroupWriter(Handle group, WriteProgress& progress) : id_(std::move(group)), progress_(&progress) {
    progress_->ok = progress_->ok && id_;
  }

  GroupWriter group(const std::string& name) const;
  void text(const char* attribute, std::string_view value) const;
  void real(const char* attribute, double value) const;
  void integer(const char* attribute, std::int64_t value) const;

  template <class Row>
  void rows(const char* name, const std::vector<Row>& values) const {
    const RowType type = row_type(values.data());
    bulk(name, type, values.size(), std::as_bytes(std::span(values)));
  }
  /// Rows of `type.columns` scalars (0: rank 1).
  void bulk(const char* name, const RowType& type, std::uint64_t row_count,
            std::span<const std::byte> bytes) const;
  /// As `rows`, but nothing for a list without entries: HDF5's readers of assets know no empty dataset.
  template <class Row>
  void rows_if_any(const char* name, const std::vector<Row>& values) const {
    if (!values.empty()) rows(name, values);
  }
  /// Bytes that stand for themselves, read piece by piece: not shuffled, small chunks.
  void records(const char* name, std::span<const std::byte> bytes) const;
  /// Texts of one fixed length, padded with NUL.
  void texts(const char* name, const std::vector<std::string>& values) const;

 private:
  void attribute(const char* name, hid_t type, const void* value) const;
  void note(bool ok) const { progress_->ok = progress_->ok && ok; }

  Handle id_;
  WriteProgress* progress_;
};

}  // namespace souple::storage
