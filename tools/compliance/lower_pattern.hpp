// SPDX-License-Identifier: GPL-3.0-or-later
// The graph of a block matrix as CHOLMOD takes it.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/fem/block_matrix.hpp"

struct cholmod_sparse_struct;

namespace souple {

/// Where the lower triangle of the part on chosen nodes may be non-zero, by columns, rows ascending.
struct LowerPattern {
  std::vector<std::int64_t> begin{0}, row;
};

/// `nodes`: chosen nodes in the order of their columns, each of `width` scalars.
LowerPattern lower_pattern(const BlockPattern& pattern, std::span<const Index> nodes,
                           std::int64_t width);

/// A view; valid as long as the pattern.
cholmod_sparse_struct as_sparse(LowerPattern& pattern);

}  // namespace souple
