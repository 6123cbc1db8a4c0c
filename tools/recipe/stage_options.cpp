// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/stage_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/geometry/surface_measure.hpp"

namespace souple {
namespace {

// The decimated surface keeps more faces than the coarse mesh will have: collapsing further makes thin
// limbs cut themselves (dino.off, 1250 tets: the mesher fails on 1000 faces and works on 1500).
constexpr double faces_per_boundary_face = 4;
constexpr double fewest_faces = 1500;
/// Of a largest error, what the wrap and the decimation may spend; the mesher gets the rest.
constexpr double repair_share = 0.5, decimation_share = 0.2, mesher_share = 0.3;

/// The place of a word in the list of choices, which is that of the enumerator.
template <class Enum, std::size_t n>
Enum choice(const std::array<const char*, n>& names, const std::string& name) {
  return static_cast<Enum>(std::ranges::find(names, name) - names.begin());
}

/// Edge of the regular tet of which `count` fill the volume: V = a^3 / (6 sqrt 2).
double edge_for(double volume_m3, double count) {
  return std::cbrt(6 * std::sqrt(2.0) * volume_m3 / count);
}

/// How many times longer than on the finest level an edge of level `l` is.
double edge_ratio(const Recipe& recipe, std::int64_t l) {
  return std::ldexp(1.0, static_cast<int>(chosen_levels(recipe) - 1 - l));
}

}  // namespace

ImportOptions import_options(const Recipe& recipe) {
  ImportOptions options;
  options.unit = recipe.surface.unit;
  options.size_m = recipe.surface.size_m;
  return options;
}

ImportTetsOptions import_tets_options(const Recipe& recipe) {
  ImportTetsOptions options;
  options.unit = recipe.surface.unit;
  options.size_m = recipe.surface.size_m;
  options.mend = recipe.surface.repair == "mend";
  return options;
}

RepairOptions repair_options(const Recipe& recipe) {
  RepairOptions options;
  options.mode = choice<RepairMode>(std::array{"auto", "mend", "wrap", "off"}, recipe.surface.repair);
  options.max_error_m = repair_share * recipe.mesh.max_error_m;
  return options;
}

TetrahedralizeOptions mesher_options(const Recipe& recipe, const std::vector<LocalSize>& local_sizes,
                                     std::int64_t level) {
  const MeshSettings& mesh = recipe.mesh;
  const double ratio = edge_ratio(recipe, level);
  TetrahedralizeOptions options;
  options.target_tet_count = static_cast<std::size_t>(
      std::llround(static_cast<double>(chosen_tets(recipe)) / (ratio * ratio * ratio)));
  options.edge_length_m = mesh.edge_length_m * ratio;
  // Red refinement and fitting quarter the distance at every level.
  options.max_error_m = mesher_share * mesh.max_error_m * ratio * ratio;
  options.interior_coarsening = mesh.interior_coarsening;
  options.mesher = choice<MesherKind>(std::array{"auto", "delaunay", "lattice"}, mesh.mesher);
  options.features = choice<FeatureMode>(std::array{"auto", "keep", "ignore"}, mesh.features);
  options.local_sizes = local_sizes;
  for (LocalSize& size : options.local_sizes) size.edge_length_m *= ratio;
  return options;
}

DecimateOptions decimate_options(const Recipe& recipe, const TriangleMesh& surface,
                                 const TetrahedralizeOptions& coarse) {
  if (recipe.mesh.max_error_m > 0) return {0, decimation_share * recipe.mesh.max_error_m};
  const double edge = coarse.edge_length_m > 0 ? coarse.edge_length_m
                                               : edge_for(std::abs(signed_volume(surface)),
                                                          static_cast<double>(coarse.target_tet_count));
  const double boundary_faces = surface_area(surface) / (std::sqrt(3.0) / 4 * edge * edge);
  const double faces = std::max(faces_per_boundary_face * boundary_faces, fewest_faces);
  return {faces < 1e9 ? static_cast<std::size_t>(faces) : std::size_t{1'000'000'000}, 0};
}

NestedHierarchyOptions nested_options(const Recipe& recipe) {
  NestedHierarchyOptions options;
  options.level_count = static_cast<int>(chosen_levels(recipe));
  options.diagonal =
      choice<DiagonalRule>(std::array{"quality", "shortest", "fixed"}, recipe.mesh.diagonal);
  options.fit = choice<FitRule>(std::array{"none", "nearest_three", "least_squares", "projection"},
                                recipe.mesh.fit);
  return options;
}

}  // namespace souple
