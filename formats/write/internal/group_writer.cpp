// SPDX-License-Identifier: MIT
#include "formats/write/internal/group_writer.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "formats/filter/zstd_filter.hpp"
#include "formats/storage/device_driver.hpp"
#include "formats/storage/layout.hpp"

namespace souple::storage {
namespace {

Handle text_type(std::size_t bytes) {
  Handle type(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.get(), std::max<std::size_t>(bytes, 1));
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

/// Whole rows up to the usual chunk size; a row larger than the largest chunk is cut into even pieces.
std::array<hsize_t, 2> chunk_shape(std::uint64_t row_count, std::uint64_t columns,
                                   std::uint64_t scalar_bytes) {
  const std::uint64_t row_bytes = columns * scalar_bytes;
  if (row_bytes > layout::largest_chunk_bytes) {
    const std::uint64_t pieces =
        (row_bytes + layout::largest_chunk_bytes - 1) / layout::largest_chunk_bytes;
    return {1, (columns + pieces - 1) / pieces};
  }
  const std::uint64_t rows = (layout::smallest_chunk_bytes + row_bytes - 1) / row_bytes;
  return {std::min(row_count, rows), columns};
}

/// A power of two: few chunks, so that their index stays small, but each a small part of the whole.
std::uint64_t record_chunk_bytes(std::uint64_t payload_bytes) {
  const std::uint64_t wanted = std::bit_ceil(payload_bytes / layout::usual_record_chunk_count + 1);
  return std::min(payload_bytes,
                  std::clamp(wanted, layout::smallest_record_chunk_bytes, layout::largest_chunk_bytes));
}

/// How the rows of a dataset are cut and packed.
struct Packing {
  std::array<hsize_t, 2> chunk;
  bool shuffle;
  int zstd_level;
};

Handle dataset_properties(int rank, const Packing& packing) {
  Handle creation(H5Pcreate(H5P_DATASET_CREATE));
  set_plain_object(creation.get());
  const auto level = static_cast<unsigned>(packing.zstd_level);
  const bool ok = H5Pset_chunk(creation.get(), rank, packing.chunk.data()) >= 0 &&
                  (!packing.shuffle || H5Pset_shuffle(creation.get()) >= 0) &&
                  H5Pset_filter(creation.get(), zstd_filter_id, H5Z_FLAG_MANDATORY, 1, &level) >= 0 &&
                  H5Pset_fletcher32(creation.get()) >= 0;
  return ok ? std::move(creation) : Handle();
}

bool write_dataset(hid_t group, const char* name, const RowType& type, std::uint64_t row_count,
                   const Packing& packing, std::span<const std::byte> bytes) {
  const int rank = type.columns == 0 ? 1 : 2;
  const std::array<hsize_t, 2> extent{row_count, type.columns};
  const Handle creation = dataset_properties(rank, packing);
  const Handle space(H5Screate_simple(rank, extent.data(), nullptr));
  // Every chunk is encoded once, straight from the caller's memory: no cache.
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS));
  H5Pset_chunk_cache(access.get(), 1, 0, 0);
  if (!creation || !space || !access) return false;
  Handle id(
      H5Dcreate2(group, name, type.scalar, space.get(), H5P_DEFAULT, creation.get(), access.get()));
  return id && H5Dwrite(id.get(), type.scalar, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) >= 0 &&
         id.close();
}

}  // namespace

GroupWriter GroupWriter::group(const std::string& name) const {
  if (!progress_->ok) return {Handle(), *progress_};
  const Handle creation(H5Pcreate(H5P_GROUP_CREATE));
  set_plain_group(creation.get());
  const Handle link(H5Pcreate(H5P_LINK_CREATE));
  H5Pset_char_encoding(link.get(), H5T_CSET_UTF8);
  return {Handle(H5Gcreate2(id_.get(), name.c_str(), link.get(), creation.get(), H5P_DEFAULT)),
          *progress_};
}

void GroupWriter::attribute(const char* name, hid_t type, const void* value) const {
  if (!progress_->ok) return;
  const Handle space(H5Screate(H5S_SCALAR));
  Handle id(H5Acreate2(id_.get(), name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT));
  note(id && H5Awrite(id.get(), type, value) >= 0 && id.close());
}

void GroupWriter::text(const char* name, std::string_view value) const {
  const Handle type = text_type(value.size());
  const std::string terminated(value);  // one NUL stands for the empty text
  attribute(name, type.get(), terminated.c_str());
}

void GroupWriter::real(const char* name, double value) const {
  attribute(name, H5T_IEEE_F64LE, &value);
}

void GroupWriter::integer(const char* name, std::int64_t value) const {
  attribute(name, H5T_STD_I64LE, &value);
}

void GroupWriter::bulk(const char* name, const RowType& type, std::uint64_t row_count,
                       std::span<const std::byte> bytes) const {
  if (!progress_->ok) return;
  const auto chunk = chunk_shape(row_count, std::max<std::size_t>(type.columns, 1), type.scalar_bytes);
  note(write_dataset(id_.get(), name, type, row_count, {chunk, true, progress_->zstd_level}, bytes));
}

void GroupWriter::records(const char* name, std::span<const std::byte> bytes) const {
  if (!progress_->ok) return;
  const Packing packing{{record_chunk_bytes(bytes.size()), 1}, false, progress_->zstd_level};
  note(write_dataset(id_.get(), name, row_type(bytes.data()), bytes.size(), packing, bytes));
}

void GroupWriter::texts(const char* name, const std::vector<std::string>& values) const {
  std::size_t width = 1;
  for (const std::string& value : values) width = std::max(width, value.size());
  std::vector<std::byte> bytes(width * values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    std::ranges::copy(std::as_bytes(std::span(values[i])), bytes.data() + i * width);
  const Handle type = text_type(width);
  bulk(name, {type.get(), width, 0}, values.size(), bytes);
}

}  // namespace souple::storage
