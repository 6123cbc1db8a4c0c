// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "formats/core/asset.hpp"
#include "tools/geometry/triangle_bvh.hpp"
#include "tools/hierarchy/nested_hierarchy.hpp"

namespace souple {

/// Sizes, quality, distance from the target and rigid motions of one level; what a level has only
/// against its parents is the caller's.
LevelReport report_of(const MeshLevel& level, const TriangleMesh& target, const TriangleBvh& triangles);

/// `parent_quality`: of every tet's parent, mean ratio.
ChildQuality child_quality(const TetMesh& mesh, const std::vector<double>& parent_quality);

}  // namespace souple
