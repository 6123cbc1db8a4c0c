// SPDX-License-Identifier: GPL-3.0-or-later
// From the file to the levels of the mesh: import -> repair -> decimate -> tetrahedralize -> hierarchy
// -> visual binding. What the recipe asks for is handed to the stages, which do the work.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "tools/exchange/tet_file.hpp"
#include "tools/hierarchy/nested_hierarchy.hpp"
#include "tools/recipe/parts.hpp"
#include "tools/recipe/recipe.hpp"
#include "tools/recipe/stages.hpp"
#include "tools/surface/decimate.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/repair.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple {

/// How the surface for display sits in the finest level.
struct VisualReport {
  std::size_t vertex_count = 0;
  std::size_t outside_count = 0;  ///< vertices outside every tet: extrapolated
  double farthest_outside_m = 0;
  double largest_weight = 0;
};

struct BodyMeshReport {
  std::string input_name, input_hash;
  double scale = 1;                             ///< metres per unit of the file
  std::optional<ImportReport> import;           ///< of a surface
  std::optional<ImportTetsReport> import_tets;  ///< of a tet mesh
  std::optional<RepairReport> repair;
  std::optional<DecimateReport> decimate;
  std::optional<TetrahedralizeReport> coarse;  ///< of the coarsest mesh, if it was made here
  std::vector<LevelReport> levels;
  std::optional<VisualReport> visual;
  std::vector<std::string> notes;
};

struct BodyMesh {
  std::vector<MeshLevel> levels;
  VisualMesh visual;
  TetLabels labels;  ///< of the finest level
  BodyMeshReport report;
};

/// The recipe must have passed check_recipe. Issues: those of the stages.
Result<BodyMesh> build_body_mesh(const Recipe& recipe, Stages& stages);

/// The hierarchy of given tet meshes: one is refined (nested), several are embedded in one another,
/// coarsest first. The target, and what is stored for display, is recipe.surface.file, or the boundary
/// of the finest mesh if that is empty. Issues: those of import_tets and of the stages.
Result<BodyMesh> build_hierarchy_of(const std::vector<std::filesystem::path>& meshes,
                                    const Recipe& recipe, Stages& stages);

}  // namespace souple
