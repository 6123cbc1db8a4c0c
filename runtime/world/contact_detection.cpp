// SPDX-License-Identifier: MIT
#include "runtime/world/contact_detection.hpp"

#include <algorithm>

namespace souple {
namespace {

constexpr int depth_divisions = 10;
// A contact whose normals point the same way joins the back of a thin part to the front of another
// body.
constexpr double same_side_cosine = 0.3;
// How deep a node inside another body is still found, relative to that body's longest side.
constexpr double inside_reach = 0.05;

ContactSide node_side(std::uint32_t body, Index node) {
  ContactSide side;
  side.body = body;
  side.count = 1;
  side.node[0] = node;
  side.weight[0] = 1;
  return side;
}

double triangle_box_depth(const RigidShape& shape, const RigidPlacement& at, const Vec3& a,
                          const Vec3& b, const Vec3& c) {
  double depth = 0;
  for (int i = 0; i <= depth_divisions; ++i)
    for (int j = 0; i + j <= depth_divisions; ++j) {
      const Vec3 point =
          a + (double(i) / depth_divisions) * (b - a) + (double(j) / depth_divisions) * (c - a);
      depth = std::max(depth, -signed_distance(shape, at, point).distance);
    }
  return depth;
}

}  // namespace

Vec3 RigidStep::motion_of(const Vec3& point) const {
  return end.rotation * (start.rotation.transpose() * (point - start.translation)) + end.translation -
         point;
}

void detect_soft_rigid(std::uint32_t soft_index, const SoftBody& soft, std::uint32_t rigid_index,
                       const RigidStep& rigid, const PairSettings& settings,
                       std::vector<Contact>& contacts) {
  for (const Index node : soft.asset->surface().nodes()) {
    if (soft.is_fixed[node]) continue;
    const Vec3 position = node_entry(soft.x, node);
    const SignedDistance found = signed_distance(rigid.body->shape, rigid.start, position);
    if (!(found.distance < settings.alarm_distance_m)) continue;
    Contact contact;
    contact.key = {soft_index, node, rigid_index};
    contact.a = node_side(soft_index, node);
    contact.b.body = rigid_index;
    contact.frame = contact_frame(found.normal);
    contact.point = position - found.distance * found.normal;
    contact.gap = found.distance;
    contact.friction = settings.friction;
    contact.driven_motion = rigid.motion_of(contact.point);
    contacts.push_back(contact);
  }
}

void detect_soft_soft(std::uint32_t a_index, const SoftBody& a, std::uint32_t b_index,
                      const SoftBody& b, const PairSettings& settings, std::vector<Contact>& contacts) {
  const double radius = settings.alarm_distance_m + inside_reach * b.asset->longest_side_m();
  Eigen::AlignedBox3d reach = b.surface.bounds();
  reach.min().array() -= radius;
  reach.max().array() += radius;
  if (!reach.intersects(a.surface.bounds())) return;
  for (const Index node : a.asset->surface().nodes()) {
    const Vec3 position = node_entry(a.x, node);
    if (!reach.contains(position)) continue;
    const SurfaceHit hit = b.surface.closest(position, radius);
    if (hit.triangle < 0) continue;
    const Vec3 outward = b.surface.pseudo_normal(hit);
    const Vec3 offset = position - hit.closest.point;
    const double gap = offset.dot(outward) < 0 ? -hit.distance : hit.distance;
    if (gap > settings.alarm_distance_m) continue;
    // Along the offset where it is well defined, so that the normal varies smoothly over edges.
    const bool touching = hit.distance < 1e-9 * b.asset->longest_side_m();
    const Vec3 normal = touching ? outward : Vec3(offset / gap);
    if (normal.dot(a.surface.vertex_normal(node)) > same_side_cosine) continue;

    const Triangle& triangle = b.asset->surface().triangles()[hit.triangle];
    Contact contact;
    contact.key = {a_index, node, b_index};
    contact.a = node_side(a_index, node);
    contact.b = {b_index, 3, triangle, hit.closest.weight};
    const bool b_moves = std::ranges::any_of(triangle, [&](Index n) { return !b.is_fixed[n]; });
    if (a.is_fixed[node] && !b_moves) continue;
    contact.frame = contact_frame(normal);
    contact.point = hit.closest.point;
    contact.gap = gap;
    contact.friction = settings.friction;
    contacts.push_back(contact);
  }
}

double node_depth(const SoftBody& soft, const RigidShape& shape, const RigidPlacement& at) {
  double depth = 0;
  for (const Index node : soft.asset->surface().nodes())
    depth = std::max(depth, -signed_distance(shape, at, node_entry(soft.x, node)).distance);
  return depth;
}

double surface_depth(const SoftBody& soft, const RigidShape& shape, const RigidPlacement& at) {
  double depth = node_depth(soft, shape, at);
  if (shape.kind == RigidShapeKind::plane) return depth;  // a linear function has its extremes at nodes
  for (const auto& t : soft.asset->surface().triangles()) {
    const Vec3 a = node_entry(soft.x, t[0]), b = node_entry(soft.x, t[1]), c = node_entry(soft.x, t[2]);
    if (shape.kind == RigidShapeKind::sphere) {
      const Vec3 nearest = closest_on_triangle(at.translation, a, b, c).point;
      depth = std::max(depth, -signed_distance(shape, at, nearest).distance);
    } else {
      const double reach = std::max((b - a).norm(), (c - a).norm());
      if (signed_distance(shape, at, a).distance < reach)
        depth = std::max(depth, triangle_box_depth(shape, at, a, b, c));
    }
  }
  return depth;
}

}  // namespace souple
