// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "tools/geometry/vector.hpp"
#include "tools/hierarchy/surface_goals.hpp"
#include "tools/hierarchy/two_sided_samples.hpp"

namespace souple {
namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Entries = std::vector<Eigen::Triplet<double>>;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// mu of METHOD 3.2. More smooths ridges away, less lets vertices bunch up.
constexpr double smoothing = 0.05;

/// Adds mu (v_i - sum_j lambda_ij v_j), lambda the mean-value weights of the neighbours on the surface
/// (Floater 2003): of each triangle at i, tan(angle / 2) over the length of either side.
void add_smoothing(const LevelSurface& surface, const std::vector<Point>& x, Entries& matrix) {
  for (std::size_t v = 0; v < x.size(); ++v) {
    std::vector<std::pair<Index, double>> weights;
    double sum = 0;
    for (const Index t : surface.triangles_of(v)) {
      const Triangle& corners = surface.triangles[at(t)];
      const auto here = std::ranges::find(corners, static_cast<Index>(v)) - corners.begin();
      const Index next = corners[static_cast<std::size_t>((here + 1) % 3)];
      const Index last = corners[static_cast<std::size_t>((here + 2) % 3)];
      const Point a = subtract(x[at(next)], x[v]), b = subtract(x[at(last)], x[v]);
      const double la = norm(a), lb = norm(b), sine = norm(cross(a, b));
      const double half_tangent = sine / (la * lb + dot(a, b));
      if (!(la > 0 && lb > 0 && std::isfinite(half_tangent))) continue;
      weights.emplace_back(next, half_tangent / la);
      weights.emplace_back(last, half_tangent / lb);
      sum += half_tangent / la + half_tangent / lb;
    }
    if (!(sum > 0)) continue;
    const int row = static_cast<int>(v);
    matrix.emplace_back(row, row, smoothing);
    for (const auto& [j, weight] : weights) matrix.emplace_back(row, j, -smoothing * weight / sum);
  }
}

/// Adds (1 - mu) (A, c): alpha = 1 for every vertex, and as much in all for the target's samples.
void add_distances(const LevelSurface& surface, const std::vector<Point>& x,
                   const TargetSurface& target, Entries& matrix, Eigen::MatrixX3d& right) {
  const std::vector<Point> closest = projection_goals(surface, x, target);
  const auto add = [&](Index row, double weight, const Point& p) {
    for (int c = 0; c < 3; ++c)
      right(row, c) += (1 - smoothing) * weight * p[static_cast<std::size_t>(c)];
  };
  for (std::size_t v = 0; v < x.size(); ++v) {
    const int row = static_cast<int>(v);
    matrix.emplace_back(row, row, 1 - smoothing);
    add(row, 1, closest[v]);
  }
  for (const SurfaceSample& s : samples_back(surface, x, target)) {
    const Triangle& t = surface.triangles[at(s.triangle)];
    const double beta = s.area * static_cast<double>(x.size());
    for (std::size_t i = 0; i < 3; ++i) {
      add(t[i], beta * s.weights[i], s.goal);
      for (std::size_t j = 0; j < 3; ++j)
        matrix.emplace_back(t[i], t[j], (1 - smoothing) * beta * s.weights[i] * s.weights[j]);
    }
  }
}

std::vector<Point> solved(const Entries& entries, const Eigen::MatrixX3d& right,
                          const std::vector<Point>& x) {
  const Eigen::Index n = right.rows();
  Sparse matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::BiCGSTAB<Sparse> solver;
  solver.setTolerance(1e-8);
  solver.setMaxIterations(200);
  solver.compute(matrix);
  std::vector<Point> places = x;
  for (Eigen::Index c = 0; c < 3; ++c) {
    Eigen::VectorXd guess(n);
    for (Eigen::Index i = 0; i < n; ++i)
      guess[i] = x[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)];
    const Eigen::VectorXd place = solver.solveWithGuess(right.col(c), guess);
    for (Eigen::Index i = 0; i < n; ++i)
      if (std::isfinite(place[i]))
        places[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)] = place[i];
  }
  return places;
}

}  // namespace

std::vector<Point> least_squares_goals(const LevelSurface& surface, const std::vector<Point>& positions,
                                       const TargetSurface& target, int lookups) {
  std::vector<Point> x = positions;
  for (int lookup = 0; lookup < lookups; ++lookup) {
    Entries matrix;
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(static_cast<Eigen::Index>(x.size()), 3);
    add_smoothing(surface, x, matrix);
    add_distances(surface, x, target, matrix, right);
    x = solved(matrix, right, x);
  }
  return x;
}

}  // namespace souple
