// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/principal_axes.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

/// Axes are taken where the principal moments differ by more than this part of the largest: closer ones
/// would turn with the rounding of the input.
constexpr double least_gap = 0.01;
/// A skewness (dimensionless) below this decides nothing.
constexpr double least_skewness = 1e-6;

using Corners = std::array<Point, 3>;

Corners corners_of(const TriangleMesh& mesh, const Triangle& t) {
  return {mesh.vertices[static_cast<std::size_t>(t[0])], mesh.vertices[static_cast<std::size_t>(t[1])],
          mesh.vertices[static_cast<std::size_t>(t[2])]};
}

double area_of(const Corners& c) { return norm(cross(subtract(c[1], c[0]), subtract(c[2], c[0]))) / 2; }

/// Calls use(corners about the surface's centroid, area) for every triangle, lengths in `unit`.
template <class Use>
void for_each_centred(const TriangleMesh& mesh, const Point& middle, double unit, const Use& use) {
  for (const Triangle& t : mesh.triangles) {
    Corners c = corners_of(mesh, t);
    for (Point& p : c) p = scaled(subtract(p, middle), 1 / unit);
    use(c, area_of(c));
  }
}

Point area_centroid(const TriangleMesh& mesh, const Point& middle, double unit) {
  Point sum{};
  double whole = 0;
  for_each_centred(mesh, middle, unit, [&](const Corners& c, double area) {
    sum = add_scaled(sum, area / 3, add(add(c[0], c[1]), c[2]));
    whole += area;
  });
  return add_scaled(middle, whole > 0 ? unit / whole : 0, sum);
}

/// Exact for linear triangles: the integral of x xT is A / 12 (sum of v vT + s sT), s the sum of the v.
Eigen::Matrix3d second_moments(const TriangleMesh& mesh, const Point& centroid, double unit) {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for_each_centred(mesh, centroid, unit, [&](const Corners& c, double area) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Point& p : c) {
      const Eigen::Vector3d v(p[0], p[1], p[2]);
      moments += area / 12 * v * v.transpose();
      sum += v;
    }
    moments += area / 12 * sum * sum.transpose();
  });
  return moments;
}

/// Of the coordinate along the axis, over the cube of its spread; the corners stand for the triangles.
double skewness(const TriangleMesh& mesh, const Point& centroid, double unit, const Point& axis) {
  double cubes = 0, squares = 0, whole = 0;
  for_each_centred(mesh, centroid, unit, [&](const Corners& c, double area) {
    for (const Point& p : c) {
      const double x = dot(p, axis);
      cubes += area * x * x * x;
      squares += area * x * x;
      whole += area;
    }
  });
  const double spread = std::sqrt(squares / whole);
  return cubes / whole / (spread * spread * spread);
}

}  // namespace

std::array<Point, 3> principal_axes(const TriangleMesh& mesh, const Point& middle, double unit) {
  const Point centroid = area_centroid(mesh, middle, unit);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(second_moments(mesh, centroid, unit));
  const Eigen::Vector3d& moments = solver.eigenvalues();  // ascending
  const double gap = std::min(moments[1] - moments[0], moments[2] - moments[1]);
  if (!(gap > least_gap * moments[2])) return {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}};
  std::array<Point, 3> axes;
  for (std::size_t k = 0; k < 2; ++k) {
    const Eigen::Vector3d v = solver.eigenvectors().col(2 - static_cast<Eigen::Index>(k));
    axes[k] = {v[0], v[1], v[2]};
    double sense = skewness(mesh, centroid, unit, axes[k]);
    if (std::abs(sense) < least_skewness) {
      Eigen::Index largest = 0;
      v.cwiseAbs().maxCoeff(&largest);
      sense = v[largest];
    }
    if (sense < 0) axes[k] = scaled(axes[k], -1);
  }
  axes[2] = cross(axes[0], axes[1]);
  return axes;
}

}  // namespace souple
