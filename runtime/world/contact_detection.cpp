// SPDX-License-Identifier: MIT
#include "runtime/world/contact_detection.hpp"

#include <algorithm>

#include "runtime/collision/shape_minima.hpp"

namespace souple {
namespace {

// How deep a point inside another body is still found, relative to the larger of the two.
constexpr double inside_reach = 0.05;

const DeformedSurface* surface_of(const WorldBody& body) {
  if (const auto* soft = std::get_if<SoftBody>(&body)) return &soft->surface;
  const auto& rigid = std::get<RigidBody>(body);
  return rigid.placed ? &rigid.placed->surface() : nullptr;
}

double size_of(const WorldBody& body) {
  if (const auto* soft = std::get_if<SoftBody>(&body)) return soft->asset->longest_side_m();
  return std::get<RigidBody>(body).longest_side();
}

ContactSide side_of(const WorldBody& body, std::uint32_t index, const SurfacePoint& point) {
  ContactSide side;
  side.body = index;
  if (!std::holds_alternative<SoftBody>(body)) return side;
  side.count = point.count;
  side.node = point.node;
  side.weight = point.weight;
  return side;
}

bool can_move(const WorldBody& body, const ContactSide& side) {
  const auto* soft = std::get_if<SoftBody>(&body);
  if (!soft) return std::get<RigidBody>(body).free.has_value();
  for (std::size_t k = 0; k < std::size_t(side.count); ++k)
    if (side.weight[k] != 0 && !soft->is_fixed[std::size_t(side.node[k])]) return true;
  return false;
}

// Points of an analytic shape that touch surfaces: centre, ends of an axis, corners (features 1, 2
// ...).
Index point_count(const WorldBody& body) {
  const auto* rigid = std::get_if<RigidBody>(&body);
  if (!rigid || rigid->placed) return 0;
  switch (rigid->shape.kind) {
    case RigidShapeKind::sphere:
      return 1;
    case RigidShapeKind::capsule:
      return 2;
    case RigidShapeKind::box:
      return 8;
    default:
      return 0;
  }
}

// A vertex is always of body A; what it touches of B may change from step to step, as may what a point
// of a shape touches of a surface.
Contact make_contact(const WorldBody& a, std::uint32_t a_index, const WorldBody& b,
                     std::uint32_t b_index, const LocalMinimum& m, bool analytic) {
  Contact c;
  const bool swap = !analytic && m.b.count == 1 && m.a.count != 1;
  c.gap = m.gap;
  if (swap) {
    c.key = {b_index, m.feature_b, a_index, -1};
    c.a = side_of(b, b_index, m.b);
    c.b = side_of(a, a_index, m.a);
    c.frame = contact_frame(-m.normal);
    c.point = m.point_b + m.gap * m.normal;
    return c;
  }
  c.key = {a_index, m.feature_a, b_index, !analytic && m.a.count == 1 ? -1 : m.feature_b};
  if (analytic && m.a.count > 1 && m.feature_b >= 1 && m.feature_b <= point_count(b))
    c.key.feature_a = -1;
  c.a = side_of(a, a_index, m.a);
  c.b = side_of(b, b_index, m.b);
  c.frame = contact_frame(m.normal);
  c.point = m.point_b;
  return c;
}

// What touches in several places is known by the nearest one; the others are numbered.
void tell_apart(std::vector<Contact>& contacts) {
  std::ranges::sort(contacts, {}, [](const Contact& c) { return std::pair(c.key, c.gap); });
  Index twin = 0;
  for (std::size_t i = 1; i < contacts.size(); ++i) {
    ContactKey& key = contacts[i].key;
    const bool same = contacts[i - 1 - std::size_t(twin)].key == key;
    twin = same ? twin + 1 : 0;
    (key.feature_b == -1 ? key.feature_b : key.feature_a) -= twin;
  }
  std::ranges::sort(contacts, {}, &Contact::key);
}

void take_minima(const WorldBody& a, std::uint32_t a_index, const WorldBody& b, std::uint32_t b_index,
                 bool analytic, PairContacts& pair) {
  for (const LocalMinimum& m : pair.minima) {
    const Contact c = make_contact(a, a_index, b, b_index, m, analytic);
    const bool swapped = c.key.body_a != a_index;
    if (can_move(swapped ? b : a, c.a) || can_move(swapped ? a : b, c.b)) pair.contacts.push_back(c);
  }
  tell_apart(pair.contacts);
}

}  // namespace

void find_near(const WorldBody& a, const WorldBody& b, PairContacts& pair) {
  const DeformedSurface *surface_a = surface_of(a), *surface_b = surface_of(b);
  const double alarm = pair.alarm_distance_m;
  const double reach = inside_reach * std::max(size_of(a), size_of(b));
  pair.contacts.clear();
  pair.minima.clear();
  if (pair.a == pair.b) {
    find_self_minima(*surface_a, alarm, reach, pair.work, pair.minima);
    return take_minima(a, pair.a, b, pair.b, false, pair);
  }
  if (surface_a && surface_b) {
    find_local_minima(*surface_a, *surface_b, alarm, reach, pair.work, pair.minima);
    return take_minima(a, pair.a, b, pair.b, false, pair);
  }
  if (surface_a) {
    const auto& shape = std::get<RigidBody>(b);
    find_shape_minima(*surface_a, shape.shape, shape.start, alarm, pair.work, pair.minima);
    return take_minima(a, pair.a, b, pair.b, true, pair);
  }
  if (surface_b) {
    const auto& shape = std::get<RigidBody>(a);
    find_shape_minima(*surface_b, shape.shape, shape.start, alarm, pair.work, pair.minima);
    return take_minima(b, pair.b, a, pair.a, true, pair);
  }
  const auto &shape_a = std::get<RigidBody>(a), &shape_b = std::get<RigidBody>(b);
  find_rigid_minima(shape_a.shape, shape_a.start, shape_b.shape, shape_b.start, alarm, pair.minima);
  take_minima(a, pair.a, b, pair.b, true, pair);
}

namespace {

// Where the nodes are at the end of the free motion.
void end_positions(const WorldBody& body, Eigen::VectorXd& end) {
  if (const auto* soft = std::get_if<SoftBody>(&body)) {
    end = soft->x + soft->motion;
    return;
  }
  const auto& rigid = std::get<RigidBody>(body);
  rigid.placed->positions_at(rigid.free_end(), end);
}

}  // namespace

bool has_surface(const WorldBody& body) { return surface_of(body) != nullptr; }

void find_swept(const WorldBody& a, const WorldBody& b, double least_depth, PairContacts& pair) {
  const DeformedSurface *surface_a = surface_of(a), *surface_b = surface_of(b);
  const double alarm = pair.alarm_distance_m;
  pair.swept.clear();
  pair.minima.clear();
  const bool flip = !surface_a && surface_b;
  if (surface_a) end_positions(a, pair.end_a);
  if (surface_b) end_positions(b, pair.end_b);
  if (surface_a && surface_b) {
    find_swept_pairs(*surface_a, pair.end_a, *surface_b, pair.end_b, alarm, pair.work, pair.swept);
  } else if (surface_a || surface_b) {
    const auto& shape = std::get<RigidBody>(flip ? a : b);
    find_swept_shape(flip ? *surface_b : *surface_a, flip ? pair.end_b : pair.end_a, shape.shape,
                     shape.start, shape.free_end(), alarm, pair.work, pair.swept);
  } else {
    const auto &one = std::get<RigidBody>(a), &two = std::get<RigidBody>(b);
    if (const auto hit = find_swept_shapes(one.shape, one.start, one.free_end(), two.shape, two.start,
                                           two.free_end(), alarm, pair.work))
      pair.swept.push_back(*hit);
  }
  for (const SweptPair& s : pair.swept)
    if (s.end_depth >= least_depth) pair.minima.push_back(s.minimum);
  const bool analytic = !surface_a || !surface_b;
  if (flip)
    take_minima(b, pair.b, a, pair.a, analytic, pair);
  else
    take_minima(a, pair.a, b, pair.b, analytic, pair);
}

namespace {

constexpr int depth_divisions = 10;

double sampled_depth(const RigidShape& shape, const RigidPlacement& at, const Vec3& a, const Vec3& b,
                     const Vec3& c) {
  double depth = 0;
  for (int i = 0; i <= depth_divisions; ++i)
    for (int j = 0; i + j <= depth_divisions; ++j) {
      const Vec3 point =
          a + (double(i) / depth_divisions) * (b - a) + (double(j) / depth_divisions) * (c - a);
      depth = std::max(depth, -signed_distance(shape, at, point).distance);
    }
  return depth;
}

double triangle_depth(const RigidShape& shape, const RigidPlacement& at, const Vec3& a, const Vec3& b,
                      const Vec3& c) {
  if (shape.kind == RigidShapeKind::sphere)
    return -signed_distance(shape, at, closest_on_triangle(at.translation, a, b, c).point).distance;
  const double reach = std::max((b - a).norm(), (c - a).norm());
  return signed_distance(shape, at, a).distance < reach ? sampled_depth(shape, at, a, b, c) : 0;
}

double depth_in_mesh(const SoftBody& soft, const RigidBody& body, const RigidPlacement& at) {
  const double reach = inside_reach * body.longest_side();
  const Eigen::AlignedBox3d box = body.placed->surface().bounds();
  double depth = 0;
  for (const Index node : soft.asset->surface().nodes()) {
    // In the frame in which the surface was refitted: the start of the step.
    const Vec3 local = at.rotation.transpose() * (node_entry(soft.x, node) - at.translation);
    const Vec3 p = body.placed->placement().rotation * local + body.placed->placement().translation;
    if (!box.contains(p)) continue;
    const SurfaceHit hit = body.placed->surface().closest(p, reach);
    if (hit.triangle < 0) continue;
    if ((p - hit.closest.point).dot(body.placed->surface().pseudo_normal(hit)) < 0)
      depth = std::max(depth, hit.distance);
  }
  return depth;
}

}  // namespace

Depths depths_in(const SoftBody& soft, const RigidBody& body, const RigidPlacement& at) {
  Depths depths;
  if (body.placed) {
    depths.node = depths.surface = depth_in_mesh(soft, body, at);
    return depths;
  }
  for (const Index node : soft.asset->surface().nodes())
    depths.node =
        std::max(depths.node, -signed_distance(body.shape, at, node_entry(soft.x, node)).distance);
  depths.surface = depths.node;
  if (body.shape.kind == RigidShapeKind::plane) return depths;  // linear: its extremes are at nodes
  for (const auto& t : soft.asset->surface().triangles())
    depths.surface =
        std::max(depths.surface, triangle_depth(body.shape, at, node_entry(soft.x, t[0]),
                                                node_entry(soft.x, t[1]), node_entry(soft.x, t[2])));
  return depths;
}

}  // namespace souple
