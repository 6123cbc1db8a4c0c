// SPDX-License-Identifier: MIT
// A box over levels, turned and stretched, and the linear system of a step of it.
#pragma once
#include <cmath>
#include <memory>
#include <vector>

#include "runtime/fem/corotational_model.hpp"
#include "tests/support/level_boxes.hpp"

namespace souple::test {

/// A box of 0.2 x 0.1 x 0.1 units, clamped at its low end where asked, turned and stretched a little.
struct BoxCase {
  double poisson = 0.4;
  double contrast = 1;  ///< stiffness of the far half over that of the near one
  double unit = 1;      ///< m
  bool is_clamped = true;
  int cells = 4;  ///< per 0.1 units; the levels below have half and a quarter
};

struct BoxProblem {
  std::vector<MeshLevel> levels;
  std::unique_ptr<CorotationalModel> model;
  std::vector<Index> fixed;
  std::unique_ptr<BlockMatrix> a;
  Eigen::VectorXd b;
};

inline Material material_for(const BoxCase& setup, const TetMesh& mesh) {
  Material material = material_of(1e4, setup.poisson, 1000, 0.1, 0.01);
  if (setup.contrast == 1) return material;
  material.regions.push_back({"far", 1e4 * setup.contrast, setup.poisson, 1000});
  for (const Tet& tet : mesh.tets)
    material.tet_region.push_back(mesh.nodes[std::size_t(tet[0])][0] < 0.1 * setup.unit ? 0 : 1);
  return material;
}

inline void fix(const std::vector<Index>& fixed, BlockMatrix& a) {
  std::vector<bool> is_fixed(a.pattern->diagonal.size());
  for (const Index node : fixed) is_fixed[std::size_t(node)] = true;
  for (Index row = 0; row < a.pattern->node_count(); ++row)
    for (Index k = a.pattern->row_begin[std::size_t(row)];
         k < a.pattern->row_begin[std::size_t(row) + 1]; ++k) {
      const Index column = a.pattern->column[std::size_t(k)];
      if (!is_fixed[std::size_t(row)] && !is_fixed[std::size_t(column)]) continue;
      a.block(k).setZero();
      if (row == column) a.block(k).setIdentity();
    }
}

inline BoxProblem make_problem(const BoxCase& setup, std::size_t level_count) {
  const Point size{0.2 * setup.unit, 0.1 * setup.unit, 0.1 * setup.unit};
  const auto cells = [&](int n) { return std::array<int, 3>{2 * n, n, n}; };
  BoxProblem p;
  p.levels.push_back(level_of(box_mesh(cells(setup.cells >> (level_count - 1)), {}, size)));
  for (std::size_t l = 1; l < level_count; ++l)
    p.levels.push_back(nested_box(cells(setup.cells >> (level_count - l)), {}, size));
  const TetMesh& mesh = p.levels.back().mesh;
  p.model = std::make_unique<CorotationalModel>(
      CorotationalModel::create(mesh, material_for(setup, mesh)).value());
  const Index n = p.model->node_count();
  p.b.setZero(3 * n);
  Eigen::VectorXd x(3 * n);
  for (Index i = 0; i < n; ++i) {
    const Vec3 rest = as_vec3(mesh.nodes[std::size_t(i)]);
    const Eigen::AngleAxisd twist(3 * rest.x() / setup.unit, Vec3::UnitX());
    node_entry(x, i) = twist * Vec3(1.1 * rest.x(), rest.y(), rest.z());
    if (setup.is_clamped && rest.x() == 0)
      p.fixed.push_back(i);
    else
      node_entry(p.b, i) = -9.81 * p.model->masses()[std::size_t(i)] * Vec3(0.1, 0.2, 1);
  }
  std::vector<Mat3> rotations(std::size_t(p.model->tet_count()));
  p.model->element_rotations(x, rotations);
  p.a = std::make_unique<BlockMatrix>(p.model->pattern());
  const double mass = setup.is_clamped ? 0 : 1e4 + 10, stiffness = setup.is_clamped ? 1 : 2;
  p.model->assemble(mass, stiffness, rotations, *p.a);
  fix(p.fixed, *p.a);
  return p;
}

}  // namespace souple::test
