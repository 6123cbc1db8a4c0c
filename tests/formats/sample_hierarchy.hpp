// SPDX-License-Identifier: MIT
// Hierarchical compliances with made-up numbers: of the right shape, sound and deterministic, but
// nobody compressed them from anything.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/core/asset.hpp"

namespace souple::test {

struct MadeUpHierarchy {
  HierarchicalIndex index;
  std::vector<std::byte> payload;
};

/// 2^depth leaves; every block has `rank` terms, or as many as its smaller side allows. The bytes have
/// about six bits of information each, as quantised factors do.
MadeUpHierarchy make_hierarchy(Index node_count, int depth, Index rank);

/// A variant on the surface of the finest level, of `depth` halvings, for steps of 0.01 s.
ComplianceVariant make_hierarchical_variant(const Asset& asset, int depth, Index rank);

/// The same on all nodes of the level below the finest, with the prolongation to the surface.
ComplianceVariant make_coarse_variant(const Asset& asset);

}  // namespace souple::test
