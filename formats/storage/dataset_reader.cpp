// SPDX-License-Identifier: MIT
#include "formats/storage/dataset_reader.hpp"

#include "formats/core/limits.hpp"
#include "formats/filter/zstd_filter.hpp"
#include "formats/storage/layout.hpp"

namespace souple::storage {
namespace {

// A zstd frame has at least 9 bytes, the fletcher32 sum 4.
constexpr std::uint64_t smallest_stored_chunk = 13;

// Decoded bytes that stored ones may stand for. Real meshes and compliances shrink 2 to 50 times; the
// allowance is for small constant lists.
constexpr std::uint64_t free_allowance = std::uint64_t{16} << 20;
constexpr std::uint64_t largest_ratio = 250;

std::uint64_t count_chunks(std::uint64_t extent, std::uint64_t chunk) {
  return (extent + chunk - 1) / chunk;
}

/// The filter at this place of the pipeline: its number, its first value, mandatory or not.
struct FilterEntry {
  H5Z_filter_t id = H5Z_FILTER_ERROR;
  unsigned first_value = 0;
  bool optional = true;
};

FilterEntry filter_at(hid_t creation, unsigned place) {
  FilterEntry entry;
  unsigned flags = 0;
  std::array<unsigned, 8> values{};
  std::size_t value_count = values.size();
  entry.id = H5Pget_filter2(creation, place, &flags, &value_count, values.data(), 0, nullptr, nullptr);
  entry.first_value = value_count > 0 ? values[0] : 0;
  entry.optional = (flags & H5Z_FLAG_OPTIONAL) != 0;
  return entry;
}

/// Shuffle may be missing where it would do nothing.
bool has_our_filters(hid_t creation, std::size_t scalar_bytes) {
  const int count = H5Pget_nfilters(creation);
  if (count != 3 && !(count == 2 && scalar_bytes == 1)) return false;
  const FilterEntry shuffle = filter_at(creation, 0);
  const FilterEntry zstd = filter_at(creation, static_cast<unsigned>(count) - 2);
  const FilterEntry sum = filter_at(creation, static_cast<unsigned>(count) - 1);
  const bool shuffled = shuffle.id == H5Z_FILTER_SHUFFLE && shuffle.first_value == scalar_bytes;
  return (count == 2 || shuffled) && zstd.id == zstd_filter_id && !zstd.optional &&
         sum.id == H5Z_FILTER_FLETCHER32;
}

}  // namespace

Issue DatasetReader::damaged(const std::string& what) const {
  return make_issue(IssueCode::asset_corrupt, what, where_);
}

Result<DatasetReader> DatasetReader::open(hid_t group, const std::string& name, std::string where,
                                          std::uint64_t file_bytes) {
  DatasetReader dataset;
  dataset.where_ = std::move(where);
  dataset.file_bytes_ = file_bytes;
  // Every chunk is decoded once, straight to where it belongs: no cache.
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS));
  H5Pset_chunk_cache(access.get(), 1, 0, 0);
  dataset.id_ = Handle(H5Dopen2(group, name.c_str(), access.get()));
  if (!dataset.id_) return dataset.damaged("the dataset cannot be opened");
  if (Status status = dataset.read_extent(); !status) return status.issue();
  if (Status status = dataset.read_type(); !status) return status.issue();
  if (Status status = dataset.check_storage(); !status) return status.issue();
  if (Status status = dataset.read_chunk_shape(); !status) return status.issue();
  return dataset;
}

Status DatasetReader::read_extent() {
  const Handle space(H5Dget_space(id_.get()));
  rank_ = H5Sget_simple_extent_ndims(space.get());
  if (rank_ != 1 && rank_ != 2) return damaged("rank " + std::to_string(rank_) + ", not 1 or 2");
  std::array<hsize_t, 2> largest{};
  H5Sget_simple_extent_dims(space.get(), extent_.data(), largest.data());
  for (int axis = 0; axis < rank_; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    if (extent_[i] == 0 || extent_[i] != largest[i]) return damaged("the extent is empty or not fixed");
    if (extent_[i] > limits::payload_bytes)
      return make_issue(IssueCode::asset_limit_exceeded, "extent " + std::to_string(extent_[i]),
                        where_);
  }
  return {};
}

Status DatasetReader::read_type() {
  type_ = Handle(H5Dget_type(id_.get()));
  scalar_bytes_ = type_ ? H5Tget_size(type_.get()) : 0;
  if (scalar_bytes_ == 0 || scalar_bytes_ > limits::name_bytes || H5Tcommitted(type_.get()) > 0 ||
      H5Tdetect_class(type_.get(), H5T_VLEN) != 0)
    return damaged("the data type cannot be read");
  // Each extent is below 2^40, so the products below stay within 64 bits step by step.
  const std::uint64_t row_bytes = extent_[1] * scalar_bytes_;
  if (row_bytes > limits::payload_bytes || extent_[0] > limits::payload_bytes / row_bytes)
    return make_issue(
        IssueCode::asset_limit_exceeded,
        "the extent is " + std::to_string(extent_[0]) + " by " + std::to_string(extent_[1]), where_);
  raw_bytes_ = extent_[0] * row_bytes;
  return {};
}

Status DatasetReader::check_storage() const {
  const Handle creation(H5Dget_create_plist(id_.get()));
  if (!creation || H5Pget_layout(creation.get()) != H5D_CHUNKED ||
      H5Pget_external_count(creation.get()) != 0)
    return damaged("the dataset is not stored in chunks of this file");
  if (!has_our_filters(creation.get(), scalar_bytes_))
    return damaged("the filters are not shuffle, zstd, fletcher32");
  return {};
}

Status DatasetReader::read_chunk_shape() {
  const Handle creation(H5Dget_create_plist(id_.get()));
  if (H5Pget_chunk(creation.get(), 2, chunk_.data()) != rank_)
    return damaged("the rank of the chunks is not that of the data");
  const bool sane = chunk_[0] > 0 && chunk_[1] > 0 && chunk_[0] <= layout::largest_chunk_bytes &&
                    chunk_[1] <= layout::largest_chunk_bytes &&
                    chunk_[0] * chunk_[1] * scalar_bytes_ <= layout::largest_chunk_bytes;
  if (!sane) return damaged("chunks above 1 MiB");
  return {};
}

std::uint64_t DatasetReader::stored_bytes() const { return H5Dget_storage_size(id_.get()); }

bool DatasetReader::has_scalar(hid_t type) const { return H5Tequal(type_.get(), type) > 0; }

bool DatasetReader::is_text() const {
  return rank_ == 1 && H5Tget_class(type_.get()) == H5T_STRING && H5Tis_variable_str(type_.get()) == 0;
}

Status DatasetReader::expect(const RowType& row) const {
  if (!has_scalar(row.scalar) || columns() != row.columns)
    return damaged("the scalar type or the width of a row is not what belongs here");
  return {};
}

std::uint64_t DatasetReader::chunk_bytes_at(const std::array<hsize_t, 2>& offset) const {
  unsigned mask = 0;
  haddr_t address = HADDR_UNDEF;
  hsize_t bytes = 0;
  if (H5Dget_chunk_info_by_coord(id_.get(), offset.data(), &mask, &address, &bytes) < 0) return 0;
  // A set bit of the mask would skip a filter, the checksum for instance.
  if (mask != 0 || address == HADDR_UNDEF || address > file_bytes_ || bytes > file_bytes_ - address)
    return 0;
  return bytes >= smallest_stored_chunk ? bytes : 0;
}

Status DatasetReader::check_chunks() const {
  const std::uint64_t down = count_chunks(extent_[0], chunk_[0]);
  const std::uint64_t across = count_chunks(extent_[1], chunk_[1]);
  const std::uint64_t most = file_bytes_ / smallest_stored_chunk;
  if (down > most || across > most / down)
    return damaged("the extent needs more chunks than fit the file");
  std::uint64_t stored = 0;
  for (std::uint64_t i = 0; i < down; ++i)
    for (std::uint64_t j = 0; j < across; ++j) {
      const std::uint64_t bytes = chunk_bytes_at({i * chunk_[0], j * chunk_[1]});
      if (bytes == 0) return damaged("a chunk is missing or damaged");
      stored += bytes;
      if (stored > file_bytes_) return damaged("the chunks are larger than the file");
    }
  if (raw_bytes_ > free_allowance && (raw_bytes_ - free_allowance) / largest_ratio > stored)
    return make_issue(
        IssueCode::asset_limit_exceeded,
        std::to_string(stored) + " stored bytes claim to hold " + std::to_string(raw_bytes_), where_);
  return {};
}

Status DatasetReader::check_chunks_and_rows(std::uint64_t row_limit) const {
  if (rows() > row_limit)
    return make_issue(IssueCode::asset_limit_exceeded,
                      std::to_string(rows()) + " rows, at most " + std::to_string(row_limit), where_);
  return check_chunks();
}

Status DatasetReader::read(std::span<std::byte> bytes) const {
  if (bytes.size() != raw_bytes_) return damaged("the buffer does not fit the data");
  return decode(H5S_ALL, H5S_ALL, bytes);
}

Status DatasetReader::read_range(std::uint64_t begin, std::span<std::byte> bytes) const {
  const bool whole_scalars = begin % scalar_bytes_ == 0 && bytes.size() % scalar_bytes_ == 0;
  if (rank_ != 1 || !whole_scalars || begin > raw_bytes_ || bytes.size() > raw_bytes_ - begin)
    return damaged("bytes " + std::to_string(begin) + " + " + std::to_string(bytes.size()) +
                   " are not part of the data");
  if (bytes.empty()) return {};
  const hsize_t start = begin / scalar_bytes_, count = bytes.size() / scalar_bytes_;
  const Handle selection(H5Dget_space(id_.get()));
  const Handle memory(H5Screate_simple(1, &count, nullptr));
  if (!selection || !memory ||
      H5Sselect_hyperslab(selection.get(), H5S_SELECT_SET, &start, nullptr, &count, nullptr) < 0)
    return damaged("a range cannot be selected");
  return decode(memory.get(), selection.get(), bytes);
}

Status DatasetReader::decode(hid_t memory, hid_t selection, std::span<std::byte> bytes) const {
  const ExpectedChunkBytes expected(static_cast<std::size_t>(chunk_bytes()));
  if (H5Dread(id_.get(), type_.get(), memory, selection, H5P_DEFAULT, bytes.data()) < 0)
    return damaged("the data cannot be decoded: a checksum or a length is wrong");
  return {};
}

}  // namespace souple::storage
