// SPDX-License-Identifier: MIT
#include "formats/filter/zstd_filter.hpp"

#include <hdf5.h>
#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>

namespace souple::storage {
namespace {

thread_local std::size_t expected_chunk_bytes = 0;  // 0: whatever the frame says

// HDF5 1.10 keeps chunks below 4 GiB; a frame that claims more is damaged.
constexpr unsigned long long largest_chunk = 0xFFFFFFFFull;

/// HDF5 takes over `fresh` (malloc, as its own buffers) in place of `*buffer`.
std::size_t replace_buffer(void* fresh, std::size_t used, std::size_t capacity,
                           std::size_t* buffer_size, void** buffer) {
  std::free(*buffer);
  *buffer = fresh;
  *buffer_size = capacity;
  return used;
}

std::size_t decode(std::size_t byte_count, std::size_t* buffer_size, void** buffer) {
  const unsigned long long claimed = ZSTD_getFrameContentSize(*buffer, byte_count);
  if (claimed == 0 || claimed > largest_chunk) return 0;  // also "unknown" and "error"
  if (expected_chunk_bytes != 0 && claimed != expected_chunk_bytes) return 0;
  const auto capacity = static_cast<std::size_t>(claimed);
  void* fresh = std::malloc(capacity);
  if (fresh == nullptr) return 0;
  const std::size_t written = ZSTD_decompress(fresh, capacity, *buffer, byte_count);
  if (ZSTD_isError(written) || written != capacity) {
    std::free(fresh);
    return 0;
  }
  return replace_buffer(fresh, written, capacity, buffer_size, buffer);
}

std::size_t encode(int level, std::size_t byte_count, std::size_t* buffer_size, void** buffer) {
  const std::size_t capacity = ZSTD_compressBound(byte_count);
  void* fresh = std::malloc(capacity);
  if (fresh == nullptr) return 0;
  const std::size_t written = ZSTD_compress(fresh, capacity, *buffer, byte_count, level);
  if (ZSTD_isError(written)) {
    std::free(fresh);
    return 0;
  }
  return replace_buffer(fresh, written, capacity, buffer_size, buffer);
}

/// The shape of H5Z_func_t; 0 means failure. cd_values[0] is the compression level.
std::size_t filter(unsigned flags, std::size_t value_count, const unsigned values[],
                   std::size_t byte_count, std::size_t* buffer_size, void** buffer) {
  if ((flags & H5Z_FLAG_REVERSE) != 0) return decode(byte_count, buffer_size, buffer);
  const unsigned level = value_count > 0 ? values[0] : 3u;
  const auto highest = static_cast<unsigned>(ZSTD_maxCLevel());
  return encode(static_cast<int>(std::clamp(level, 1u, highest)), byte_count, buffer_size, buffer);
}

const H5Z_class2_t filter_class{H5Z_CLASS_T_VERS, zstd_filter_id, 1,       1,
                                "zstd",           nullptr,        nullptr, filter};

}  // namespace

const H5Z_class2_t& zstd_filter_class() { return filter_class; }

ExpectedChunkBytes::ExpectedChunkBytes(std::size_t bytes) { expected_chunk_bytes = bytes; }
ExpectedChunkBytes::~ExpectedChunkBytes() { expected_chunk_bytes = 0; }

}  // namespace souple::storage
