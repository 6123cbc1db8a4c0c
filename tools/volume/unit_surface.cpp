// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/unit_surface.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr double grid = 0x1p20;
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

/// Principal axes, longest first, each pointing where the surface has its longer tail.
std::array<Point, 3> axes_of(const TriangleMesh& mesh, const Point& middle, double unit) {
  const Point centroid = area_centroid(mesh, middle, unit);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(second_moments(mesh, centroid, unit));
  const Eigen::Vector3d& moments = solver.eigenvalues();  // ascending
  const double gap = std::min(moments[1] - moments[0], moments[2] - moments[1]);
  if (!(gap > least_gap * moments[2])) return PrincipalFrame{}.axes;
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

bool has_area(const TriangleMesh& mesh, const Triangle& t) {
  const Corners c = corners_of(mesh, t);
  // Exact on the grid: products of 21-bit integers.
  return cross(subtract(c[1], c[0]), subtract(c[2], c[0])) != Point{};
}

}  // namespace

Point PrincipalFrame::to_world(const Point& u) const {
  const Point turned = add_scaled(add_scaled(scaled(axes[0], u[0]), u[1], axes[1]), u[2], axes[2]);
  return add_scaled(origin, length_m, turned);
}

Point PrincipalFrame::to_unit(const Point& x) const {
  const Point d = scaled(subtract(x, origin), 1 / length_m);
  return {dot(d, axes[0]), dot(d, axes[1]), dot(d, axes[2])};
}

Result<UnitSurface> to_unit_surface(const TriangleMesh& surface) {
  if (const Status valid = check_closed_oriented_manifold(surface); !valid) return valid.issue();
  const Box box = bounding_box(surface.vertices);
  UnitSurface unit;
  PrincipalFrame& frame = unit.frame;
  frame.origin = scaled(add(box.low, box.high), 0.5);
  frame.length_m = longest_side(box);
  if (!(frame.length_m > 0) || !std::isfinite(frame.length_m))
    return make_issue(IssueCode::surface_no_volume, "all vertices lie in one point");
  frame.axes = axes_of(surface, frame.origin, frame.length_m);

  std::vector<Point> turned;
  for (const Point& p : surface.vertices) turned.push_back(frame.to_unit(p));
  const Box turned_box = bounding_box(turned);
  const Point middle = scaled(add(turned_box.low, turned_box.high), 0.5);
  const double side = longest_side(turned_box);
  frame.origin = frame.to_world(middle);
  frame.length_m *= side;
  for (const Point& p : turned) {
    const Point q = scaled(subtract(p, middle), grid / side);
    unit.mesh.vertices.push_back(
        {std::nearbyint(q[0]) / grid, std::nearbyint(q[1]) / grid, std::nearbyint(q[2]) / grid});
  }
  for (const Triangle& t : surface.triangles)
    if (has_area(unit.mesh, t)) unit.mesh.triangles.push_back(t);
  const double volume = signed_volume(unit.mesh);
  if (!(volume > 1e-9))
    return make_issue(IssueCode::surface_no_volume,
                      "the volume is " + std::to_string(volume * 1e9) + "e-9 of the cube of its size");
  return unit;
}

}  // namespace souple
