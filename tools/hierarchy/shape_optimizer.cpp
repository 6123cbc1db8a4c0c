// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/shape_optimizer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr int most_halvings = 5;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// m^-1 v by Cramer's rule; zero if m is not positive.
Point solved(const Symmetric& m, const Point& v) {
  const Point a{m[0], m[3], m[4]}, b{m[3], m[1], m[5]}, c{m[4], m[5], m[2]};
  const Point bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const double determinant = dot(a, bc);
  if (!(determinant > 0)) return {};
  return scaled({dot(v, bc), dot(v, ca), dot(v, ab)}, 1 / determinant);
}

}  // namespace

Point times(const Symmetric& m, const Point& v) {
  return {m[0] * v[0] + m[3] * v[1] + m[4] * v[2], m[3] * v[0] + m[1] * v[1] + m[5] * v[2],
          m[4] * v[0] + m[5] * v[1] + m[2] * v[2]};
}

ShapeOptimizer::ShapeOptimizer(const TetMesh& mesh, const std::vector<double>& parent_quality)
    : mesh_(mesh), parent_quality_(parent_quality), node_tets_(mesh) {
  weights_.reserve(parent_quality.size());
  for (const double q : parent_quality) weights_.push_back(q * q * q);
}

double ShapeOptimizer::kept(std::size_t tet) const {
  return mean_ratio(mesh_.tets[tet], mesh_.nodes) / parent_quality_[tet];
}

double ShapeOptimizer::energy_at(std::size_t node, const Point& x, const Attraction& attraction) const {
  const Point way = subtract(x, attraction.goal);
  double energy = dot(way, times(attraction.stiffness, way));
  for (const auto& [tet, corner] : node_tets_.of(node)) {
    const Tet& t = mesh_.tets[at(tet)];
    const auto& face = inward_face[corner];
    const auto other = [&](std::size_t k) -> const Point& {
      return mesh_.nodes[at(t[static_cast<std::size_t>(face[k])])];
    };
    const double s = weights_[at(tet)] * distortion_value(x, other(0), other(1), other(2));
    energy += s * s;
  }
  return energy;
}

Point ShapeOptimizer::improved(std::size_t node, const Attraction& attraction) const {
  const Point start = mesh_.nodes[node];
  const Point way = subtract(start, attraction.goal), pull = times(attraction.stiffness, way);
  double energy = dot(way, pull);
  Point gradient = scaled(pull, 2);
  Symmetric hessian;
  for (std::size_t k = 0; k < 6; ++k) hessian[k] = 2 * attraction.stiffness[k];
  for (const auto& [tet, corner] : node_tets_.of(node)) {
    const Tet& t = mesh_.tets[at(tet)];
    const auto& face = inward_face[corner];
    const auto other = [&](std::size_t k) -> const Point& {
      return mesh_.nodes[at(t[static_cast<std::size_t>(face[k])])];
    };
    const Distortion d = distortion(start, other(0), other(1), other(2));
    const double s = weights_[at(tet)] * d.value, e = s * s;
    // e = exp(2 log s): e' = 2 e a, e'' = 2 e (2 a a^T + (log s)'').
    const Point& a = d.log_gradient;
    energy += e;
    gradient = add_scaled(gradient, 2 * e, a);
    const Symmetric outer{a[0] * a[0], a[1] * a[1], a[2] * a[2], a[0] * a[1], a[0] * a[2], a[1] * a[2]};
    for (std::size_t k = 0; k < 6; ++k) hessian[k] += 2 * e * (2 * outer[k] + d.log_hessian[k]);
  }
  if (!std::isfinite(energy)) return start;
  Point step = solved(hessian, gradient);
  for (int halving = 0; halving < most_halvings; ++halving) {
    const Point place = subtract(start, step);
    if (energy_at(node, place, attraction) < energy) return place;
    step = scaled(step, 0.5);
  }
  return start;
}

}  // namespace souple
