// SPDX-License-Identifier: MIT
// Products with matrices of 16-bit integers times a unit. Both factors are rounded to integers, so that
// one instruction multiplies sixteen numbers: two to three times as fast as widening halves to floats.
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace souple {

/// 16-bit numbers, aligned for whole vectors.
using PackedValues = std::vector<std::uint16_t, Eigen::aligned_allocator<std::uint16_t>>;

/// A block of 16-bit integers by columns, of which every one begins at a multiple of 16.
struct IntegerBlock {
  const std::uint16_t* values = nullptr;  ///< rows_padded x columns, one more column if that is odd
  std::size_t rows = 0, columns = 0;
  float unit = 1;              ///< of a stored integer
  std::int32_t most = 32'767;  ///< of a rounded factor, so that no sum leaves 32 bits

  std::size_t rows_padded() const { return (rows + 15) / 16 * 16; }
};

/// Appends a matrix; the block that it gives has its `values` not set.
IntegerBlock append_integers(const Eigen::MatrixXd& matrix, PackedValues& values);

/// y += M x, rows_padded entries of y. `scratch`: at least integer_scratch(columns) entries.
void add_product(const IntegerBlock& m, const float* x, float* y, float* scratch);

/// y -= M^T x. `scratch`: at least integer_scratch(rows) entries.
void subtract_transposed_product(const IntegerBlock& m, const float* x, float* y, float* scratch);

/// Floats whose room holds `count` integers of 16 bits, rounded up to whole vectors.
constexpr std::size_t integer_scratch(std::size_t count) { return (count + 15) / 16 * 8; }

}  // namespace souple
