// SPDX-License-Identifier: GPL-3.0-or-later
// What the words of a recipe mean to the stages. `bake` and the verbs of single stages share them.
#pragma once
#include <cstdint>
#include <vector>

#include "tools/exchange/tet_file.hpp"
#include "tools/hierarchy/nested_hierarchy.hpp"
#include "tools/recipe/recipe.hpp"
#include "tools/surface/decimate.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/repair.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple {

ImportOptions import_options(const Recipe& recipe);
ImportTetsOptions import_tets_options(const Recipe& recipe);
RepairOptions repair_options(const Recipe& recipe);
/// Of level `level`, 0 the coarsest: edges double and errors quadruple from level to level.
TetrahedralizeOptions mesher_options(const Recipe& recipe, const std::vector<LocalSize>& local_sizes,
                                     std::int64_t level);
/// Enough faces for what the mesher will be asked for.
DecimateOptions decimate_options(const Recipe& recipe, const TriangleMesh& surface,
                                 const TetrahedralizeOptions& coarse);
NestedHierarchyOptions nested_options(const Recipe& recipe);

}  // namespace souple
