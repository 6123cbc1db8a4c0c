// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/core/result.hpp"
#include "formats/storage/hdf5_session.hpp"
#include "formats/storage/row_type.hpp"

namespace souple::storage {

/// One dataset: chunked, shuffled (bytes may go without), zstd, fletcher32, of rank 1 or 2 and fixed
/// extent; anything else is refused when it is opened. Opening reads headers only.
class DatasetReader {
 public:
  /// `file_bytes` bounds what the dataset may claim to store.
  static Result<DatasetReader> open(hid_t group, const std::string& name, std::string where,
                                    std::uint64_t file_bytes);

  std::uint64_t rows() const { return extent_[0]; }
  std::uint64_t columns() const { return rank_ == 2 ? extent_[1] : 0; }  ///< 0: rank 1
  std::uint64_t raw_bytes() const { return raw_bytes_; }
  std::uint64_t stored_bytes() const;
  std::size_t scalar_bytes() const { return scalar_bytes_; }
  std::uint64_t chunk_bytes() const { return chunk_[0] * chunk_[1] * scalar_bytes_; }  ///< decoded
  bool has_scalar(hid_t type) const;
  /// Fixed-length UTF-8 text, rank 1.
  bool is_text() const;

  /// asset_corrupt unless scalar type, rank and width are these.
  Status expect(const RowType& row) const;
  /// Decodes everything into `bytes`, of length raw_bytes(). Call check_chunks first.
  Status read(std::span<std::byte> bytes) const;
  /// Rank 1: fills `bytes` from byte `begin`, decoding the chunks it lies in and no others.
  /// asset_corrupt also if the range leaves the extent or cuts a scalar. Call check_chunks first.
  Status read_range(std::uint64_t begin, std::span<std::byte> bytes) const;
  /// Every chunk is there, complete, inside the file and of a plausible size: what has to hold before
  /// memory is taken for the decoded data. asset_corrupt, asset_limit_exceeded.
  Status check_chunks() const;

  /// Checks, allocates and reads.
  template <class Row>
  Result<std::vector<Row>> read_all(std::uint64_t row_limit) const {
    if (Status status = check_chunks_and_rows(row_limit); !status) return status.issue();
    std::vector<Row> result(raw_bytes_ / sizeof(Row));
    if (Status status = read(std::as_writable_bytes(std::span(result))); !status) return status.issue();
    return result;
  }

 private:
  DatasetReader() = default;
  Status read_extent();
  Status read_type();
  Status check_storage() const;
  Status read_chunk_shape();
  Status decode(hid_t memory, hid_t selection, std::span<std::byte> bytes) const;
  Status check_chunks_and_rows(std::uint64_t row_limit) const;
  /// Stored bytes of the chunk at this element offset, 0 if it is not as it must be.
  std::uint64_t chunk_bytes_at(const std::array<hsize_t, 2>& offset) const;
  Issue damaged(const std::string& what) const;

  Handle id_;
  Handle type_;
  std::string where_;
  std::uint64_t file_bytes_ = 0;
  int rank_ = 0;
  std::array<hsize_t, 2> extent_{1, 1};
  std::array<hsize_t, 2> chunk_{1, 1};
  std::size_t scalar_bytes_ = 0;
  std::uint64_t raw_bytes_ = 0;
};

}  // namespace souple::storage
