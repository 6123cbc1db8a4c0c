// SPDX-License-Identifier: MIT
#include "runtime/collision/ray_pick.hpp"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The part of the ray inside the box, of [0, length]; false: none. `inverse` is 1 / direction.
bool meets(const FloatBox& box, const Ray& ray, const Vec3& inverse, double length) {
  double enter = 0, leave = length;
  for (int k = 0; k < 3; ++k) {
    const double low = box.low[k], high = box.high[k];
    if (ray.direction[k] == 0) {
      if (ray.origin[k] < low || ray.origin[k] > high) return false;
      continue;
    }
    const double p = (low - ray.origin[k]) * inverse[k], q = (high - ray.origin[k]) * inverse[k];
    enter = std::max(enter, std::min(p, q));
    leave = std::min(leave, std::max(p, q));
  }
  // The planes are rounded outward by more than these products are off.
  return enter <= leave * (1 + 1e-12) + 1e-300;
}

// By signed volumes of the ray with the edges (Plücker coordinates), which two triangles at an edge
// compute alike: the ray cannot slip between them.
std::optional<RayHit> meet_triangle(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 p = a - ray.origin, q = b - ray.origin, r = c - ray.origin;
  const double wa = ray.direction.dot(q.cross(r)), wb = ray.direction.dot(r.cross(p)),
               wc = ray.direction.dot(p.cross(q));
  if ((wa < 0 || wb < 0 || wc < 0) && (wa > 0 || wb > 0 || wc > 0)) return std::nullopt;
  const double sum = wa + wb + wc;
  if (!(sum != 0)) return std::nullopt;
  RayHit hit;
  hit.weight = {wa / sum, wb / sum, wc / sum};
  hit.distance = (hit.weight[0] * p + hit.weight[1] * q + hit.weight[2] * r).dot(ray.direction);
  return hit;
}

RayHit at_distance(double distance, const Vec3& normal) { return {distance, -1, {}, normal}; }

std::optional<RayHit> meet_sphere(double radius, const Vec3& centre, const Ray& ray) {
  const Vec3 from = ray.origin - centre;
  const double along = from.dot(ray.direction);
  // The square of the nearest approach from the point there: no cancellation for far origins.
  const double root2 = radius * radius - (from - along * ray.direction).squaredNorm();
  if (root2 < 0) return std::nullopt;
  const double root = std::sqrt(root2);
  const double distance = -along - root >= 0 ? -along - root : -along + root;
  if (distance < 0) return std::nullopt;
  const Vec3 outward = from + distance * ray.direction;
  return at_distance(distance, outward.norm() > 0 ? Vec3(outward.normalized()) : Vec3::UnitZ());
}

std::optional<RayHit> meet_plane(const Ray& ray) {
  if (ray.direction.z() == 0) return std::nullopt;
  const double distance = -ray.origin.z() / ray.direction.z();
  if (!(distance >= 0)) return std::nullopt;
  return at_distance(distance, Vec3::UnitZ());
}

std::optional<RayHit> meet_box(const Vec3& half, const Ray& ray) {
  double enter = -infinity, leave = infinity;
  int enter_axis = 0, leave_axis = 0;
  for (int k = 0; k < 3; ++k) {
    if (ray.direction[k] == 0) {
      if (std::abs(ray.origin[k]) > half[k]) return std::nullopt;
      continue;
    }
    const double side = std::copysign(half[k], ray.direction[k]);
    const double p = (-side - ray.origin[k]) / ray.direction[k];
    const double q = (side - ray.origin[k]) / ray.direction[k];
    if (p > enter) enter_axis = k, enter = p;
    if (q < leave) leave_axis = k, leave = q;
  }
  if (enter > leave || leave < 0) return std::nullopt;
  const bool from_inside = enter < 0;
  const int axis = from_inside ? leave_axis : enter_axis;
  const double sign = (ray.direction[axis] > 0) == from_inside ? 1 : -1;
  return at_distance(from_inside ? leave : enter, sign * Vec3::Unit(axis));
}

// The side of an endless cylinder along z; the caps are spheres.
std::optional<RayHit> meet_capsule(double radius, double half, const Ray& ray) {
  std::optional<RayHit> best;
  const bool inside =
      (ray.origin - std::clamp(ray.origin.z(), -half, half) * Vec3::UnitZ()).norm() < radius;
  // From inside the last of the surfaces of its parts is the capsule's, from outside the first.
  const auto offer = [&](const std::optional<RayHit>& hit) {
    if (hit && (!best || (inside ? hit->distance > best->distance : hit->distance < best->distance)))
      best = hit;
  };
  const Eigen::Vector2d from = ray.origin.head<2>(), direction = ray.direction.head<2>();
  const double a = direction.squaredNorm(), b = from.dot(direction);
  const double c = from.squaredNorm() - radius * radius;
  if (a > 0 && b * b - a * c >= 0) {
    const double root = std::sqrt(b * b - a * c);
    const double distance = (inside ? -b + root : -b - root) / a;
    const Vec3 at = ray.origin + distance * ray.direction;
    if (distance >= 0 && std::abs(at.z()) <= half)
      offer(at_distance(distance, Vec3(at.x(), at.y(), 0).normalized()));
  }
  for (const double end : {-half, half}) {
    const Vec3 centre = end * Vec3::UnitZ();
    auto hit = meet_sphere(radius, centre, ray);
    if (inside && hit) {
      const double along = (ray.origin - centre).dot(ray.direction);
      hit->distance = std::max(hit->distance, -2 * along - hit->distance);
      hit->normal = (ray.origin + hit->distance * ray.direction - centre).normalized();
    }
    offer(hit);
  }
  return best;
}

}  // namespace

std::optional<RayHit> pick(const DeformedSurface& surface, const Ray& ray) {
  std::optional<RayHit> best;
  double length = ray.length;
  const Vec3 inverse = ray.direction.cwiseInverse();
  std::array<Index, 64> stack;  // depth is log2(triangles / leaf size) + 1
  int top = 0;
  if (!surface.boxes().empty()) stack[top++] = 0;
  while (top > 0) {
    const Index self = stack[--top];
    if (!meets(surface.box(self), ray, inverse, length)) continue;
    const auto& node = surface.tree().tree()[self];
    for (const Index t : surface.tree().leaf_triangles(node)) {
      auto hit = meet_triangle(ray, surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2));
      if (!hit || !(hit->distance >= 0) || hit->distance > length) continue;
      if (best && hit->distance == best->distance && t > best->triangle) continue;
      hit->triangle = t;
      hit->normal = surface.face_normal(t);
      length = hit->distance;
      best = hit;
    }
    if (node.is_leaf()) continue;
    stack[top++] = node.right;
    stack[top++] = node.left;
  }
  return best;
}

std::optional<RayHit> pick(const RigidShape& shape, const RigidPlacement& at, const Ray& ray) {
  Ray local = ray;
  local.origin = at.rotation.transpose() * (ray.origin - at.translation);
  local.direction = at.rotation.transpose() * ray.direction;
  std::optional<RayHit> hit;
  switch (shape.kind) {
    case RigidShapeKind::plane:
      hit = meet_plane(local);
      break;
    case RigidShapeKind::sphere:
      hit = meet_sphere(shape.radius_m, Vec3::Zero(), local);
      break;
    case RigidShapeKind::box:
      hit = meet_box(as_vec3(shape.half_extents_m), local);
      break;
    case RigidShapeKind::capsule:
      hit = meet_capsule(shape.radius_m, shape.half_length_m, local);
      break;
    case RigidShapeKind::mesh:
      break;
  }
  if (!hit || hit->distance > ray.length) return std::nullopt;
  hit->normal = at.rotation * hit->normal;
  return hit;
}

}  // namespace souple
