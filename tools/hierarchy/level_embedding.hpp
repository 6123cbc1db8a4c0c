// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "formats/core/asset.hpp"

namespace souple {

/// The place of every node of a nested level in the coarser one: of all tets at its parents the one
/// that holds it, or that it is least outside of; so that no node of a limb is bound to another limb.
std::vector<Embedding> embed_children(const std::vector<Point>& nodes,
                                      const std::vector<std::array<Index, 2>>& parents,
                                      const TetMesh& coarse);

/// See RigidMotionError, for the prolongation by parents and by embedding; -1 for what is empty.
RigidMotionError measure_rigid_motion(const MeshLevel& level, const TetMesh& coarse);

}  // namespace souple
