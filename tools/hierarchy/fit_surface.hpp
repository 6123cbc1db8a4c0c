// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

#include "formats/core/mesh.hpp"
#include "tools/hierarchy/nested_hierarchy.hpp"
#include "tools/hierarchy/target_surface.hpp"

namespace souple {

/// Moves the boundary nodes of a refined mesh to where the rule wants them and all inner nodes along,
/// then every free node to where its tets are best against their parents (`parent_quality`, mean ratio,
/// one per tet). A boundary node goes only as far as its tets stay sound: returns how many ended short
/// of their goal. Every tet stays positive. Nothing moves under FitRule::none. Deterministic.
std::size_t fit_to_surface(TetMesh& mesh, const std::vector<Triangle>& boundary,
                           const std::vector<double>& parent_quality, const TargetSurface& target,
                           FitRule rule);

}  // namespace souple
