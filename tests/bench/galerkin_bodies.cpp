// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/galerkin_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/bench/liver.hpp"
#include "tests/support/box_mesh.hpp"
#include "tools/hierarchy/embedded_hierarchy.hpp"
#include "tools/hierarchy/nested_hierarchy.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/prepare.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple::bench {
namespace {

std::vector<MeshLevel> box_levels(const BodyChoice& choice) {
  const auto& cells = choice.cells;
  const double edge = 0.2 / std::hypot(cells[0], cells[1], cells[2]);
  const TetMesh coarse = test::box_mesh(cells, {}, {edge * cells[0], edge * cells[1], edge * cells[2]});
  NestedHierarchyOptions options;
  options.level_count = choice.level_count;
  options.fit = FitRule::none;
  const TriangleMesh target{coarse.nodes, boundary_triangles(coarse.tets)};
  return value_or_exit(build_nested_hierarchy(coarse, target, options)).levels;
}

TetMesh filled(const TriangleMesh& surface, std::size_t tets) {
  TetrahedralizeOptions options;
  options.target_tet_count = tets;
  return value_or_exit(tetrahedralize(surface, options)).mesh;
}

std::vector<MeshLevel> liver_levels(const BodyChoice& choice) {
  ImportOptions import;
  import.size_m = 0.2;
  const auto imported =
      value_or_exit(import_surface(data_folder() / "surfaces/liver-smooth.obj", import));
  const TriangleMesh surface = value_or_exit(orient_closed_surface(imported.mesh)).mesh;
  if (choice.kind == LevelKind::fitted) {
    NestedHierarchyOptions options;
    options.level_count = choice.level_count;
    return value_or_exit(build_nested_hierarchy(filled(surface, choice.coarse_tets), surface, options))
        .levels;
  }
  std::vector<TetMesh> meshes;
  for (int l = 0; l < choice.level_count; ++l)
    meshes.push_back(filled(surface, choice.coarse_tets << (3 * l)));
  return value_or_exit(build_embedded_hierarchy(meshes, surface)).levels;
}

/// Rotations by about 20 degrees, every element's its own: a rest matrix would be too regular.
std::vector<Mat3> turned_elements(Index count) {
  std::mt19937 random(1);
  std::normal_distribution<double> angle(0, 0.2);
  std::vector<Mat3> rotations(static_cast<std::size_t>(count));
  for (Mat3& r : rotations)
    r = Eigen::Quaterniond(1, angle(random), angle(random), angle(random))
            .normalized()
            .toRotationMatrix();
  return rotations;
}

}  // namespace

const std::vector<BodyChoice>& galerkin_bodies() {
  static const std::vector<BodyChoice> bodies{
      {"box_432_2", LevelKind::unmoved, 0, {3, 3, 1}, 2},
      {"box_1152_2", LevelKind::unmoved, 0, {4, 3, 2}, 2},
      {"box_3456_2", LevelKind::unmoved, 0, {6, 4, 3}, 2},
      {"box_7680_3", LevelKind::unmoved, 0, {5, 2, 2}, 3},
      {"box_100k_3", LevelKind::unmoved, 0, {13, 5, 4}, 3},
      {"fitted_7k_3", LevelKind::fitted, 112, {}, 3},
      {"fitted_100k_3", LevelKind::fitted, 1562, {}, 3},
      {"embedded_7k_3", LevelKind::embedded, 112, {}, 3},
      {"embedded_100k_3", LevelKind::embedded, 1562, {}, 3},
  };
  return bodies;
}

GalerkinBody make_galerkin_body(const BodyChoice& choice) {
  std::vector<MeshLevel> levels =
      choice.kind == LevelKind::unmoved ? box_levels(choice) : liver_levels(choice);
  const Material material = test::material_of(1e4, 0.4, 1000, 0.1, 0.01);
  auto model = std::make_unique<const CorotationalModel>(
      value_or_exit(CorotationalModel::create(levels.back().mesh, material)));
  std::vector<Mat3> rotations = turned_elements(model->tet_count());
  BlockMatrix a(model->pattern());
  model->assemble(mass_factor, stiffness_factor, rotations, a);
  BlockMatrixF fine(model->pattern());
  std::ranges::copy(a.values, fine.values.begin());
  std::vector<Prolongation> prolongations;
  for (std::size_t l = levels.size() - 1; l > 0; --l)
    prolongations.push_back(value_or_exit(prolongation_of(levels[l], levels[l - 1])));
  return {choice.kind,          std::move(levels), std::move(model),
          std::move(rotations), std::move(fine),   std::move(prolongations)};
}

}  // namespace souple::bench
