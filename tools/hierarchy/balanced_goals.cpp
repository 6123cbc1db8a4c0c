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

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// A vertex moves at most so far, in longest edges at it.
constexpr double most_move = 0.3;
/// A sample whose goal is farther than this, in longest edges, belongs to a feature that the level does
/// not resolve.
constexpr double most_gap = 0.5;
/// Samples weigh up to so much more the farther off they are, so that the largest distance falls too.
constexpr double most_emphasis = 16;
/// And the vertices beside them are drawn up to so many times as hard.
constexpr double urgency_rate = 0.3, most_urgency = 6;

/// The rows of sum over samples of weight (m . (sum_k w_k v_k - goal))^2 + anchors |v_i - x_i|^2 for
/// the moves v - x of the vertices, m the target's normal: distances from its planes, so that the
/// vertices may slide along it, and from two planes at once come to its ridges.
class PlaneFit {
 public:
  PlaneFit(const LevelSurface& surface, const std::vector<Point>& x)
      : surface_(surface), x_(x), metrics_(x.size()), urgency_(x.size(), 1) {
    for (std::size_t v = 0; v < x.size(); ++v) reach_.push_back(surface.reach(x, v));
  }

  void add_samples(const std::vector<SurfaceSample>& samples) {
    double mean2 = 0;
    for (const SurfaceSample& s : samples)
      if (const double g = gap(s); is_near(s)) mean2 += s.area * g * g;
    for (const SurfaceSample& s : samples) {
      if (!is_near(s)) continue;
      const double g = gap(s);
      const double excess = mean2 > 0 ? g * g / mean2 : 0;
      add_row(s, g, std::sqrt(s.area * std::min(1 + excess, most_emphasis)));
      raise_urgency(s, excess);
    }
  }

  const std::vector<double>& urgency() const { return urgency_; }

  std::vector<Symmetric> metrics() const {
    std::vector<Symmetric> metrics = metrics_;
    for (Symmetric& m : metrics) {
      // Frobenius: ridges and corners are not held less than smooth places are.
      const double size = std::sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2] +
                                    2 * (m[3] * m[3] + m[4] * m[4] + m[5] * m[5]));
      for (double& entry : m) entry = size > 0 ? entry / size : 0;
    }
    return metrics;
  }

  /// Anchoring is relative to the mean diagonal entry of the normal equations.
  std::vector<Point> solve(double anchoring) {
    const auto n = static_cast<Eigen::Index>(3 * x_.size());
    double trace = 0;
    for (const auto& e : entries_) trace += e.value() * e.value();
    if (!(trace > 0)) return x_;
    const double hold = std::sqrt(anchoring * trace / static_cast<double>(n));
    for (Eigen::Index i = 0; i < n; ++i) {
      entries_.emplace_back(static_cast<int>(right_.size()), static_cast<int>(i), hold);
      right_.push_back(0);
    }
    Sparse rows(static_cast<Eigen::Index>(right_.size()), n);
    rows.setFromTriplets(entries_.begin(), entries_.end());
    Eigen::LeastSquaresConjugateGradient<Sparse> solver;
    solver.setTolerance(1e-3);
    solver.setMaxIterations(100);
    const Eigen::Map<const Eigen::VectorXd> right(right_.data(), rows.rows());
    const Eigen::VectorXd moves = solver.compute(rows).solve(right);
    return moved(moves);
  }

 private:
  Point place(const SurfaceSample& s) const {
    const Triangle& t = surface_.triangles[at(s.triangle)];
    Point p{};
    for (std::size_t k = 0; k < 3; ++k) p = add_scaled(p, s.weights[k], x_[at(t[k])]);
    return p;
  }
  double gap(const SurfaceSample& s) const { return dot(subtract(s.goal, place(s)), s.normal); }
  bool is_near(const SurfaceSample& s) const {
    const Triangle& t = surface_.triangles[at(s.triangle)];
    const double most = most_gap * std::max({reach_[at(t[0])], reach_[at(t[1])], reach_[at(t[2])]});
    return squared_norm(subtract(s.goal, place(s))) <= most * most;
  }

  void add_row(const SurfaceSample& s, double gap, double weight) {
    const auto row = static_cast<int>(right_.size());
    const Triangle& t = surface_.triangles[at(s.triangle)];
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 3; ++c)
        entries_.emplace_back(row, 3 * t[k] + static_cast<int>(c), weight * s.weights[k] * s.normal[c]);
    right_.push_back(weight * gap);
    const Point& m = s.normal;
    const Symmetric outer{m[0] * m[0], m[1] * m[1], m[2] * m[2], m[0] * m[1], m[0] * m[2], m[1] * m[2]};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 6; ++c)
        metrics_[at(t[k])][c] += s.area * s.weights[k] * s.weights[k] * outer[c];
  }

  void raise_urgency(const SurfaceSample& s, double excess) {
    const Triangle& t = surface_.triangles[at(s.triangle)];
    for (std::size_t k = 0; k < 3; ++k) {
      const double wanted = 1 + urgency_rate * s.weights[k] * excess;
      urgency_[at(t[k])] = std::max(urgency_[at(t[k])], std::min(wanted, most_urgency));
    }
  }

  std::vector<Point> moved(const Eigen::VectorXd& moves) const {
    std::vector<Point> goals = x_;
    for (std::size_t v = 0; v < x_.size(); ++v) {
      const auto i = static_cast<Eigen::Index>(3 * v);
      const Point move{moves[i], moves[i + 1], moves[i + 2]};
      const double length = norm(move), most = most_move * reach_[v];
      if (!std::isfinite(length)) continue;
      goals[v] = add_scaled(x_[v], length > most ? most / length : 1, move);
    }
    return goals;
  }

  const LevelSurface& surface_;
  const std::vector<Point>& x_;
  std::vector<double> reach_;
  std::vector<Symmetric> metrics_;
  std::vector<double> urgency_;
  std::vector<double> right_;
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace

BalancedGoals balanced_goals(const LevelSurface& surface, const std::vector<Point>& positions,
                             const TargetSurface& target, double anchoring) {
  PlaneFit fit(surface, positions);
  fit.add_samples(samples_forth(surface, positions, target));
  fit.add_samples(samples_back(surface, positions, target));
  return {fit.solve(anchoring), fit.metrics(), fit.urgency()};
}

}  // namespace souple
