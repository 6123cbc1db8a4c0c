// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "runtime/fem/linear_algebra.hpp"
#include "tools/compliance/single_factor.hpp"

namespace souple {

/// The 3x3 diagonal blocks of (L L^T)^-1 at `places` (first of three scalars, in elimination order):
/// Takahashi's recurrence from the roots down, front by front, along the supernodes that the factor's
/// wanted scalars reach (Takahashi, Fagan, Chen 1973; Erisman, Tinney 1975). Costs about two
/// factorisations. Empty if cancelled.
std::vector<Mat3> inverse_diagonal_blocks(const SingleFactor& factor,
                                          std::span<const std::int64_t> places,
                                          const std::function<bool()>& cancelled);

/// Most bytes that it holds at once.
std::size_t selected_inverse_bytes(const SingleFactor& factor);

}  // namespace souple
