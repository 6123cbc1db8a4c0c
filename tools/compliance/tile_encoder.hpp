// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

#include "formats/core/asset.hpp"
#include "runtime/compliance/dense_tiled_compliance.hpp"
#include "tools/compliance/symmetric_source.hpp"

namespace souple {

/// The tiles as stored scalars, and what that cost: frobenius, worst_column, and an upper bound of
/// scaled_spectral (the Frobenius norm of the same scaled difference) are filled into `error`.
std::vector<std::byte> encode_tiles(const SymmetricSource& source, const TileLayout& layout,
                                    ScalarType scalar, ComplianceError& error);

}  // namespace souple
