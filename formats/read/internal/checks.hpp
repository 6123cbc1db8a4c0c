// SPDX-License-Identifier: MIT
// The checks of an asset's content, part by part. The reader runs those that make a part safe to use,
// validation runs all.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/read/internal/issue_list.hpp"

namespace souple::checks {

/// How much of a level there is to point at.
struct MeshCounts {
  std::size_t nodes = 0;
  std::size_t tets = 0;
};

/// Finite coordinates within the limit; indices of tets and boundary in range.
void check_level_mesh(const MeshLevel& level, const std::string& where, IssueList& issues);
/// What ties the level to the coarser one can be followed: parents and embedding in range, weights
/// sound. `coarse` is {0, 0} for level 0.
void check_level_ties(const MeshLevel& level, const MeshCounts& coarse, const std::string& where,
                      IssueList& issues);
/// Orientation, boundary, unused nodes. Needs indices in range.
void check_level_shape(const MeshLevel& level, const std::string& where, IssueList& issues);
/// Parents against the edges of the coarser level. Needs indices in range.
void check_parents(const MeshLevel& coarse, const MeshLevel& fine, const std::string& where,
                   IssueList& issues);
/// The embedding against the rest positions. Needs sound ties.
void check_level_places(const MeshLevel& coarse, const MeshLevel& fine, const std::string& where,
                        IssueList& issues);

/// Prolongation, pattern and plan can be followed: indices in range, lists as long as they say. That
/// they are those of the levels is for the simulation to check, which has the matrix.
void check_transition(const LevelTransition& transition, std::size_t fine_nodes,
                      std::size_t coarse_nodes, const std::string& where, IssueList& issues);

/// One row per point, tets in range, weights finite and of sum 1.
void check_embedding(const std::vector<Embedding>& rows, std::size_t point_count, std::size_t tet_count,
                     const std::string& where, IssueList& issues);

/// Coordinates, triangles and embedding can be used; `tet_count` of the finest level.
void check_visual(const VisualMesh& visual, std::size_t tet_count, const std::string& where,
                  IssueList& issues);
/// The embedding against the rest positions. Needs a visual surface that can be used.
void check_visual_places(const VisualMesh& visual, const TetMesh& finest, const std::string& where,
                         IssueList& issues);

/// Numbers in range, regions of tets known; `tet_count` of the finest level.
void check_material(const Material& material, std::size_t tet_count, const std::string& where,
                    IssueList& issues);

/// Sorted, unique, in range, not empty, not all; `node_count` of the finest level.
void check_fixed_set(const FixedSet& set, std::size_t node_count, const std::string& where,
                     IssueList& issues);

/// The header in itself: counts fit each other and the representation, numbers finite.
void check_compliance_header(const ComplianceHeader& header, const std::string& where,
                             IssueList& issues);
/// Header, nodes, prolongation and hierarchical index together, for a payload of so many bytes;
/// `node_count` of the finest level.
void check_compliance_index(const ComplianceVariant& variant, std::uint64_t payload_bytes,
                            std::size_t node_count, const std::string& where, IssueList& issues);
/// The same, and the scalars of a dense payload.
void check_compliance(const ComplianceVariant& variant, std::size_t node_count,
                      const std::string& where, IssueList& issues);
/// The variant against the damping and the fixed sets of its asset.
void check_compliance_context(const ComplianceVariant& variant, const Asset& asset,
                              const std::string& where, IssueList& issues);

/// Names unique and valid, texts storable.
void check_names(const Asset& asset, IssueList& issues);

}  // namespace souple::checks
