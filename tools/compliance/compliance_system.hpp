// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "runtime/fem/block_matrix.hpp"
#include "tools/compliance/prepared_body.hpp"

namespace souple {

/// A0 of one level and the nodes that the compliance is asked for.
struct ComplianceSystem {
  std::unique_ptr<const BlockPattern> pattern;  ///< that `a0` refers to
  std::unique_ptr<BlockMatrix> a0;
  std::vector<Index> free_nodes;  ///< of `a0`, ascending: the unknowns
  std::vector<Index> order;       ///< of `free_nodes`, to eliminate them in; empty: not chosen yet
  std::vector<Index> nodes;       ///< of `a0`, ascending, free: one per row of the compliance
  std::vector<Index> chosen;      ///< where they stand among `free_nodes`
  std::vector<Point> positions;   ///< of the rows in the rest shape, m
  std::string worst_element;      ///< for messages: "worst element: tet 12"
};

/// a_M M + a_K K of the body with `fixed` taken out. `touched` (ascending; empty: all) limits
/// the rows. Issues: mesh_element_invalid, material_out_of_range, fixed_set_invalid,
/// compliance_region_empty.
Result<ComplianceSystem> build_system(PreparedBody& body, const FixedSet* fixed,
                                      std::span<const Index> touched, double mass_factor,
                                      double stiffness_factor);

struct CoarseSystem {
  ComplianceSystem system;                    ///< rows: nodes of the coarser level
  std::vector<RowProlongation> prolongation;  ///< of every row of the finest level's system
};

/// P^T A0 P with P from `level`'s embedding in `coarser`, or from its parents; fixed nodes stay where
/// they are, so their rows of P are empty. Issues: recipe_needs_coarser_level.
Result<CoarseSystem> build_coarse_system(const ComplianceSystem& fine, const MeshLevel& level,
                                         const MeshLevel& coarser);

}  // namespace souple
