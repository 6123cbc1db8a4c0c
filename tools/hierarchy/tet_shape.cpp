// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/tet_shape.hpp"

#include <cmath>
#include <limits>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

double squared_edges(const Point& a, const Point& b, const Point& c, const Point& d) {
  double sum = 0;
  for (const Point& e :
       {subtract(b, a), subtract(c, a), subtract(d, a), subtract(c, b), subtract(d, b), subtract(d, c)})
    sum += squared_norm(e);
  return sum;
}

double distortion_of(double edges2, double volume6) {
  if (!(volume6 > 0)) return std::numeric_limits<double>::infinity();
  return edges2 * edges2 * edges2 / (432 * volume6 * volume6);
}

}  // namespace

double mean_ratio(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double edges2 = squared_edges(a, b, c, d);
  if (!(edges2 > 0)) return 0;
  const double volume3 = signed_volume6(a, b, c, d) / 2;
  const double root = std::cbrt(std::abs(volume3));
  return std::copysign(12 * root * root / edges2, volume3);
}

double mean_ratio(const Tet& tet, const std::vector<Point>& nodes) {
  return mean_ratio(nodes[at(tet[0])], nodes[at(tet[1])], nodes[at(tet[2])], nodes[at(tet[3])]);
}

double distortion_value(const Point& x, const Point& b, const Point& c, const Point& d) {
  return distortion_of(squared_edges(x, b, c, d), signed_volume6(x, b, c, d));
}

Distortion distortion(const Point& x, const Point& b, const Point& c, const Point& d) {
  const double edges2 = squared_edges(x, b, c, d);
  const Point normal = cross(subtract(c, b), subtract(d, b));
  const double volume6 = dot(normal, subtract(b, x));
  Distortion result;
  result.value = distortion_of(edges2, volume6);
  if (!(volume6 > 0)) return result;
  // log s = 3 log S - 2 log D + const; s' = 2 sum (x - corner), s'' = 6 I, D' = -normal.
  const Point s = scaled(subtract(scaled(x, 3), add(add(b, c), d)), 2 / edges2);
  const Point n = scaled(normal, -1 / volume6);
  result.log_gradient = add_scaled(scaled(s, 3), -2, n);
  const auto entry = [&](std::size_t i, std::size_t j) { return 2 * n[i] * n[j] - 3 * s[i] * s[j]; };
  const double diagonal = 18 / edges2;
  result.log_hessian[0] = entry(0, 0) + diagonal;
  result.log_hessian[1] = entry(1, 1) + diagonal;
  result.log_hessian[2] = entry(2, 2) + diagonal;
  result.log_hessian[3] = entry(0, 1);
  result.log_hessian[4] = entry(0, 2);
  result.log_hessian[5] = entry(1, 2);
  return result;
}

NodeTets::NodeTets(const TetMesh& mesh)
    : first_(mesh.nodes.size() + 1, 0), corners_(4 * mesh.tets.size()) {
  for (const Tet& tet : mesh.tets)
    for (const Index i : tet) ++first_[at(i) + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (std::size_t k = 0; k < 4; ++k)
      corners_[next[at(mesh.tets[t][k])]++] = {static_cast<Index>(t), static_cast<Index>(k)};
}

}  // namespace souple
