// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <vector>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// A dense matrix of `height` rows in single precision, laid out for adding multiples of its columns:
/// entry (row, column) at values()[column * stride() + row]. Columns are contiguous, begin at 64-byte
/// boundaries and are padded with zeros to a multiple of 16 rows. Resizing allocates only to grow.
class PaddedColumns {
 public:
  static constexpr std::size_t pack = 16;

  /// All zero.
  void reset(std::size_t height, std::size_t width);

  std::size_t height() const { return height_; }
  std::size_t width() const { return width_; }
  std::size_t stride() const { return stride_; }  ///< padded height
  float* column(std::size_t c) { return values() + c * stride_; }
  const float* column(std::size_t c) const { return values() + c * stride_; }

  /// Rows 3i.. and columns 3j..
  Mat3 block(std::size_t i, std::size_t j) const;
  void add_to_block(std::size_t i, std::size_t j, const Mat3& block);

  /// y += columns 3j, 3j+1, 3j+2 times change; y has stride() entries, those of `float` aligned to 64
  /// bytes. In the precision of y.
  void add_product(std::size_t j, const Vec3& change, float* y) const;
  void add_product(std::size_t j, const Vec3& change, double* y) const;

 private:
  float* values() { return storage_.data() + offset_; }
  const float* values() const { return storage_.data() + offset_; }

  std::size_t height_ = 0, width_ = 0, stride_ = 0, offset_ = 0;
  std::vector<float> storage_;
};

/// The first entry of `storage` at a 64-byte boundary; `storage` has 15 entries to spare.
std::size_t aligned_offset(const std::vector<float>& storage);

}  // namespace souple
