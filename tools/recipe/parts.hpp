// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of the body that a recipe names: where the mesh is finer, where the material is another.
#pragma once
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "tools/recipe/recipe.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple {

struct BodyParts {
  std::vector<LocalSize> local_sizes;
  std::string file_hashes;  ///< of the files that were read, one after another
};

/// `surface`: the body's own, metres; `scale`: metres per unit of the files. Issues: those of
/// import_surface, config_bad_value (a part that holds nothing of the surface).
Result<BodyParts> read_local_sizes(const Recipe& recipe, const TriangleMesh& surface, double scale);

/// How well a region is met by whole tets.
struct RegionReport {
  std::string name;
  std::size_t tet_count = 0;
  double volume_m3 = 0;          ///< of its tets
  double wanted_volume_m3 = -1;  ///< of the part itself where it lies inside the body; -1: not known
};

struct RegionAssignment {
  std::vector<MaterialRegion> regions;  ///< the recipe's [material] first
  std::vector<Index> tet_region;        ///< empty: one region only
  std::vector<RegionReport> reports;
  std::string file_hashes;
};

/// Labels of a given tet mesh: of every tet the number of its name.
struct TetLabels {
  std::vector<Index> of_tets;  ///< empty: none
  std::vector<std::string> names;
};

/// The region of every tet by its middle or its label. Issues: those of import_surface and
/// repair_surface for files, config_bad_value for a region without tets or an unknown group.
Result<RegionAssignment> assign_regions(const Recipe& recipe, const TetMesh& mesh,
                                        const TetLabels& labels, double scale);

}  // namespace souple
