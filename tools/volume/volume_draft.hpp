// SPDX-License-Identifier: GPL-3.0-or-later
// What a mesher hands over, before the tets are put in order and measured.
#pragma once
#include <string>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"
#include "tools/volume/size_goal.hpp"
#include "tools/volume/sizing.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple {

struct VolumeDraft {
  TetMesh mesh;  ///< in the frame of the unit surface
  int attempts = 0;
  FeatureReport features;
  std::vector<std::string> notes;
};

/// CGAL Mesh_3 with features where they are to be kept.
Result<VolumeDraft> mesh_by_delaunay(const UnitSurface& unit, const Sizing& sizing,
                                     const SizeGoal& goal, FeatureMode features);

/// Mean over the six edges of every tet.
double mean_edge_of(const TetMesh& mesh);

}  // namespace souple
