// SPDX-License-Identifier: MIT
// The Zstandard filter of HDF5, registered number 32015. Linked into reader and writer, and built as
// the plugin `libh5zstd.so` so that other HDF5 programs open assets.
#pragma once
#include <cstddef>

struct H5Z_class2_t;

namespace souple::storage {

inline constexpr int zstd_filter_id = 32015;

const H5Z_class2_t& zstd_filter_class();

/// While alive, decoding on this thread refuses chunks whose decoded size is not `bytes`: HDF5 1.10
/// does not compare the two and would read past the end of a shorter one.
class ExpectedChunkBytes {
 public:
  explicit ExpectedChunkBytes(std::size_t bytes);
  ~ExpectedChunkBytes();
  ExpectedChunkBytes(const ExpectedChunkBytes&) = delete;
  ExpectedChunkBytes& operator=(const ExpectedChunkBytes&) = delete;
};

}  // namespace souple::storage
