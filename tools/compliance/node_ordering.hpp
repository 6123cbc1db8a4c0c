// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/fem/block_matrix.hpp"

namespace souple {

/// An order in which to eliminate `nodes` (places in that list), in postorder: nested dissection of
/// whole nodes rather than scalars, a ninth of the graph, and the three scalars of a node stay
/// together. The dissection hangs on how the nodes are numbered, by a fifth in flops on real bodies; so
/// several numberings are tried, as many as pay, and the cheapest is kept: for the Gram form over
/// `surface` (nodes of `nodes`; METHOD 4.2) or, where that is empty, for the factorisation alone. The
/// same for the same input. Issue compliance_out_of_memory.
Result<std::vector<Index>> order_nodes(const BlockPattern& pattern, std::span<const Index> nodes,
                                       std::span<const Index> surface);

}  // namespace souple
