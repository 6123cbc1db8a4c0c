// SPDX-License-Identifier: GPL-3.0-or-later
// Reports of the mesh stages as JSON and as text; `bake` and the verbs of single stages share them.
#pragma once
#include <string>

#include "tools/cli/json_output.hpp"
#include "tools/recipe/body_mesh.hpp"

namespace souple {

Json import_json(const ImportReport& report);
Json import_tets_json(const ImportTetsReport& report);
Json triage_json(const SurfaceTriage& triage);
Json repair_json(const RepairReport& report);
Json decimate_json(const DecimateReport& report);
Json quality_json(const TetQuality& quality);
Json tetrahedralize_json(const TetrahedralizeReport& report);
Json levels_json(const std::vector<LevelReport>& reports);
/// Everything of a body's mesh; null for stages that were not run.
Json body_mesh_json(const BodyMeshReport& report);

/// "grade repairable: 3 holes, 2 self-intersections", a line per finding with -v.
std::string triage_text(const SurfaceTriage& triage);
/// What was done, a line per action, and how far the surface moved.
std::string repair_text(const RepairReport& report);
/// A line per level.
std::string levels_text(const std::vector<LevelReport>& reports);

}  // namespace souple
