// SPDX-License-Identifier: MIT
// Matrices and prolongations to multiply, and the same as dense matrices.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "runtime/fem/corotational_model.hpp"
#include "runtime/multigrid/galerkin_plan.hpp"
#include "tests/support/level_boxes.hpp"

namespace souple::test {

inline constexpr Point origin{0, 0, 0}, box{0.2, 0.15, 0.1};

/// A tangent matrix of a body whose elements are all turned differently, and a prolongation under it.
struct Problem {
  CorotationalModel model;
  Prolongation p;
  BlockMatrixF fine{model.pattern()};

  Problem(const MeshLevel& fine_level, const MeshLevel& coarse_level)
      : model(
            std::move(CorotationalModel::create(fine_level.mesh, material_of(1e4, 0.4, 1000))).value()),
        p(prolongation_of(fine_level, coarse_level).value()) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::vector<Mat3> rotations(std::size_t(model.tet_count()));
    for (Mat3& r : rotations)
      r = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
              .normalized()
              .toRotationMatrix();
    BlockMatrix a(model.pattern());
    model.assemble(1e4, 2, rotations, a);
    for (std::size_t k = 0; k < a.values.size(); ++k) fine.values[k] = float(a.values[k]);
    make_symmetric();
  }

  void make_symmetric() {
    const BlockPattern& pattern = model.pattern();
    for (Index i = 0; i < pattern.node_count(); ++i)
      for (Index k = pattern.row_begin[std::size_t(i)]; k < pattern.row_begin[std::size_t(i) + 1]; ++k)
        if (pattern.column[std::size_t(k)] >= i)
          fine.block(pattern.find(pattern.column[std::size_t(k)], i)) =
              fine.block(k).transpose().eval();
    for (const Index k : pattern.diagonal)
      fine.block(k) = fine.block(k).selfadjointView<Eigen::Upper>().toDenseMatrix().eval();
  }

  /// Identity rows and columns, and no rows of P.
  void fix(const std::vector<Index>& nodes) {
    const BlockPattern& pattern = model.pattern();
    for (const Index i : nodes)
      for (Index k = pattern.row_begin[std::size_t(i)]; k < pattern.row_begin[std::size_t(i) + 1];
           ++k) {
        fine.block(k).setZero();
        fine.block(pattern.find(pattern.column[std::size_t(k)], i)).setZero();
        if (pattern.column[std::size_t(k)] == i) fine.block(k).setIdentity();
      }
    p = without_rows(p, nodes);
  }
};

inline Eigen::MatrixXd dense(const BlockMatrixF& a) {
  const Index n = a.pattern->node_count();
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (Index i = 0; i < n; ++i)
    for (Index k = a.pattern->row_begin[std::size_t(i)]; k < a.pattern->row_begin[std::size_t(i) + 1];
         ++k)
      m.block<3, 3>(3 * i, 3 * a.pattern->column[std::size_t(k)]) = a.block(k).cast<double>();
  return m;
}

inline Eigen::MatrixXd dense(const Prolongation& p) {
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(3 * p.fine_count(), 3 * p.coarse_count);
  for (Index i = 0; i < p.fine_count(); ++i)
    for (Index k = p.row_begin[std::size_t(i)]; k < p.row_begin[std::size_t(i) + 1]; ++k)
      m.block<3, 3>(3 * i, 3 * p.column[std::size_t(k)]) = p.weight[std::size_t(k)] * Mat3::Identity();
  return m;
}

inline BlockMatrixF replayed(const GalerkinPlan& plan, const BlockMatrixF& fine) {
  BlockMatrixF coarse(plan.coarse_pattern());
  std::ranges::fill(coarse.values, 7.0F);  // what is left over of the step before
  plan.replay(fine, coarse);
  return coarse;
}

inline MeshLevel coarse_box() { return level_of(box_mesh({3, 2, 2}, origin, box)); }

inline Problem nested() { return {nested_box({3, 2, 2}, origin, box), coarse_box()}; }

inline Problem embedded() {
  const MeshLevel coarse =
      level_of(irregular_box_mesh({3, 2, 2}, {0.005, 0.01, 0.005}, {0.19, 0.13, 0.09}, 1));
  return {embedded_level(irregular_box_mesh({5, 4, 3}, origin, box, 1), coarse.mesh), coarse};
}

}  // namespace souple::test
