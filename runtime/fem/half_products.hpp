// SPDX-License-Identifier: MIT
// Products with matrices of half-precision floats (IEEE binary16), by columns of a multiple of 8 rows.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/fem/integer_products.hpp"

namespace souple {

/// Appends the values rounded to halves; beyond the range of halves the largest one.
void append_halves(std::span<const float> values, PackedValues& halves);

/// y += M x. M is rows x columns; `rows` is a multiple of 8.
void add_product(const std::uint16_t* m, std::size_t rows, std::size_t columns, const float* x,
                 float* y);

/// y -= M^T x.
void subtract_transposed_product(const std::uint16_t* m, std::size_t rows, std::size_t columns,
                                 const float* x, float* y);

}  // namespace souple
