// SPDX-License-Identifier: MIT
// From opened groups to plain structs, checked so far that using them is safe. Internal to the reader.
#pragma once
#include <string>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "formats/read/internal/checks.hpp"
#include "formats/storage/group_reader.hpp"

namespace souple::storage {

using checks::MeshCounts;

Result<MeshCounts> read_level_counts(const GroupReader& level);  ///< from headers
/// What ties a level to the coarser one, from headers.
struct LevelTies {
  bool parents = false;
  bool embedding = false;
  RigidMotionError rigid_motion_error;
};
Result<LevelTies> read_level_ties(const GroupReader& level);
/// Nodes, tets and boundary alone.
Result<MeshLevel> read_level_mesh(const GroupReader& level);
/// All of it; `coarse` is {0, 0} for level 0.
Result<MeshLevel> read_level(const GroupReader& level, const MeshCounts& coarse);
Result<LevelTransition> read_transition(const GroupReader& group, const MeshCounts& fine,
                                        const MeshCounts& coarse);
Result<VisualMesh> read_visual(const GroupReader& visual, const MeshCounts& finest);
Result<Material> read_material(const GroupReader& material, const MeshCounts& finest);
Result<FixedSet> read_fixed_set(const GroupReader& set, std::string name, const MeshCounts& finest);

}  // namespace souple::storage
