// SPDX-License-Identifier: MIT
#include "runtime/collision/feature_minima.hpp"

#include <cmath>
#include <limits>

#include "runtime/collision/local_minima.hpp"

namespace souple {
namespace {

// Cosine by which a neighbour may come nearer before a minimum is none: rounding only.
constexpr double rounding_cosine = 1e-9;
// Below this part of the length of a side a point touches a triangle.
constexpr double touching = 1e-9;

bool no_nearer(const Vec3& towards, const Vec3& offset) {
  return towards.dot(offset) <= rounding_cosine * towards.norm() * offset.norm();
}

bool is_edge_minimum(const DeformedSurface& s, Index triangle, int side, const Vec3& offset) {
  const auto& topology = s.topology();
  const auto& edge = topology.edges[topology.triangle_edges[triangle][side]];
  const Index other = edge.triangle[0] == triangle ? edge.triangle[1] : edge.triangle[0];
  if (other < 0) return true;
  const Vec3 from = s.position(edge.vertex[0]);
  const Vec3 along = (s.position(edge.vertex[1]) - from).normalized();
  for (const Index v : topology.corners[other]) {
    if (v == edge.vertex[0] || v == edge.vertex[1]) continue;
    const Vec3 arm = s.position(v) - from;
    if (!no_nearer(arm - arm.dot(along) * along, offset)) return false;
  }
  return true;
}

bool is_vertex_minimum(const DeformedSurface& s, Index vertex, const Vec3& offset) {
  const Vec3 at = s.position(vertex);
  for (const Index v : s.topology().ring(vertex))
    if (!no_nearer(s.position(v) - at, offset)) return false;
  return true;
}

Vec3 square_to(const Vec3& arm, const Vec3& along) {
  return (arm - arm.dot(along) * along).normalized();
}

}  // namespace

PointMinima point_minima(const DeformedSurface& s, Index triangle, const Vec3& point, double radius,
                         double beside) {
  PointMinima result;
  PointMinimum found;
  found.triangle = triangle;
  found.closest = s.closest_on(triangle, point);
  const Vec3 offset = point - found.closest.point;
  const double distance2 = offset.squaredNorm();
  if (!(distance2 <= radius * radius)) return result;
  const int feature = found.closest.feature;
  const Vec3 face = s.face_normal(triangle);
  const double height = offset.dot(face);
  if (feature == 6 || (offset - height * face).squaredNorm() <= beside * beside) {
    found.feature = s.tree().face_feature(triangle);
    found.normal = face;
    found.gap = height;
    if (!face.isZero()) result.found[result.count++] = found;
    if (feature == 6) return result;
  }
  // In touch an edge or a vertex has no direction of its own; its faces do.
  const double size = (s.corner(triangle, 1) - s.corner(triangle, 0)).norm();
  if (result.count > 0 && distance2 <= touching * touching * size * size) return result;
  const Index vertex = feature < 3 ? s.topology().corners[triangle][feature] : -1;
  if (feature < 3 ? !is_vertex_minimum(s, vertex, offset)
                  : !is_edge_minimum(s, triangle, feature - 3, offset))
    return result;
  found.feature = feature < 3
                      ? s.tree().vertex_feature(vertex)
                      : s.tree().edge_feature(s.topology().triangle_edges[triangle][feature - 3]);
  const Vec3 outward = s.pseudo_normal(triangle, found.closest);
  const double distance = std::sqrt(distance2);
  found.gap = offset.dot(outward) < 0 ? -distance : distance;
  found.normal = offset / found.gap;
  result.found[result.count++] = found;
  return result;
}

SurfacePoint surface_point(const DeformedSurface& s, const PointMinimum& minimum) {
  SurfacePoint result;
  const Triangle& triangle = s.tree().triangles()[minimum.triangle];
  const int feature = minimum.closest.feature;
  for (int k = 0; k < 3; ++k) {
    const bool carries =
        feature == 6 || (feature < 3 ? k == feature : k == feature - 3 || k == (feature - 2) % 3);
    if (!carries) continue;
    result.node[result.count] = triangle[k];
    result.weight[result.count++] = minimum.closest.weight[k];
  }
  return result;
}

double winding_number(const DeformedSurface& s, const Vec3& point) {
  double sum = 0;
  for (std::size_t t = 0; t < s.topology().corners.size(); ++t) {
    const auto triangle = static_cast<Index>(t);
    const Vec3 a = s.corner(triangle, 0) - point, b = s.corner(triangle, 1) - point,
               c = s.corner(triangle, 2) - point;
    const double na = a.norm(), nb = b.norm(), nc = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), na * nb * nc + a.dot(b) * nc + b.dot(c) * na + c.dot(a) * nb);
  }
  return sum / (2 * M_PI);
}

double depth_inside(const DeformedSurface& s, const Vec3& point) {
  if (s.boxes().empty() || !s.bounds().contains(point)) return 0;
  const SurfaceHit hit = s.closest(point, std::numeric_limits<double>::infinity());
  const bool inside = hit.triangle >= 0 && (point - hit.closest.point).dot(s.pseudo_normal(hit)) < 0 &&
                      (!is_doubtful(hit.closest) || winding_number(s, point) > 0.5);
  return inside ? hit.distance : 0;
}

bool in_vertex_cone(const DeformedSurface& s, Index vertex, const Vec3& direction, double slack) {
  const Vec3 at = s.position(vertex);
  for (const Index v : s.topology().ring(vertex)) {
    const Vec3 arm = s.position(v) - at;
    if (arm.dot(direction) > slack * arm.norm()) return false;
  }
  return true;
}

std::optional<Ridge> make_ridge(const Vec3& from, const Vec3& to, const Vec3& beside1,
                                const Vec3& normal1, const Vec3& beside2, const Vec3& normal2) {
  Ridge ridge;
  ridge.from = from;
  ridge.to = to;
  const Vec3 along = (to - from).normalized();
  ridge.inward = {square_to(beside1 - from, along), square_to(beside2 - from, along)};
  // Convex: the second face falls away from the plane of the first, by the sine of the turn.
  const double fall = -normal1.dot(ridge.inward[1]);
  const bool is_blade = normal1.dot(normal2) < -0.9;
  if (!(fall > (is_blade ? 0 : least_ridge))) return std::nullopt;
  // The first sum vanishes at a blade, the second on a plane.
  ridge.outward = (normal1 + normal2 - ridge.inward[0] - ridge.inward[1]).normalized();
  return ridge;
}

std::optional<Ridge> ridge_of(const DeformedSurface& s, Index edge) {
  const auto& topology = s.topology();
  const auto& e = topology.edges[edge];
  if (e.triangle[1] < 0) return std::nullopt;
  std::array<Vec3, 2> beside;
  for (int side = 0; side < 2; ++side)
    for (const Index v : topology.corners[e.triangle[side]])
      if (v != e.vertex[0] && v != e.vertex[1]) beside[side] = s.position(v);
  return make_ridge(s.position(e.vertex[0]), s.position(e.vertex[1]), beside[0],
                    s.face_normal(e.triangle[0]), beside[1], s.face_normal(e.triangle[1]));
}

std::optional<EdgeMinimum> edge_crossing(const Ridge& a, const Ridge& b) {
  const Vec3 u = a.to - a.from, v = b.to - b.from, w = a.from - b.from;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 1e-6 * uu * vv)) return std::nullopt;  // parallel: their ends touch
  EdgeMinimum found;
  found.along_a = (uv * v.dot(w) - vv * u.dot(w)) / determinant;
  found.along_b = (uu * v.dot(w) - uv * u.dot(w)) / determinant;
  if (!(found.along_a > 0 && found.along_a < 1 && found.along_b > 0 && found.along_b < 1))
    return std::nullopt;
  found.normal = u.cross(v).normalized();
  if (found.normal.dot(b.outward - a.outward) < 0) found.normal = -found.normal;
  found.gap = w.dot(found.normal);
  return found;
}

std::optional<EdgeMinimum> edge_minimum(const Ridge& a, const Ridge& b) {
  const auto found = edge_crossing(a, b);
  if (!found) return found;
  for (int side = 0; side < 2; ++side)
    if (found->normal.dot(b.inward[side]) > edge_cone_slack ||
        found->normal.dot(a.inward[side]) < -edge_cone_slack)
      return std::nullopt;
  if (found->normal.dot(b.outward) <= 0 || found->normal.dot(a.outward) >= 0) return std::nullopt;
  return found;
}

bool pierces(const Vec3& from, const Vec3& to, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, area = u.cross(v);
  const double start = area.dot(from - a), end = area.dot(to - a);
  if (!((start < 0) != (end < 0))) return false;
  const Vec3 at = from + (start / (start - end)) * (to - from) - a;
  const double w1 = area.dot(at.cross(v)), w2 = area.dot(u.cross(at));
  return w1 > 0 && w2 > 0 && w1 + w2 < area.squaredNorm();
}

}  // namespace souple
