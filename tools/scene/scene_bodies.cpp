// SPDX-License-Identifier: GPL-3.0-or-later
// `[[body]]` of a scene.
#include <array>
#include <limits>

#include "tools/scene/scene_parts.hpp"

namespace souple {
namespace {

// Wide enough for any scene, narrow enough that no product of two of them overflows.
constexpr NumberRange speed_range{-1e6, 1e6};
constexpr NumberRange length_range{0, 1e6, true};
constexpr NumberRange mass_range{0, 1e12, true};

const std::array<std::string, 2> body_kinds{"soft", "rigid"};
const std::array<std::string, 5> shape_kinds{"plane", "sphere", "box", "capsule", "mesh"};
constexpr std::array<std::string_view, 23> body_keys{
    "kind",  "name",     "asset",   "position",  "rotation", "velocity", "angular_velocity", "fixed",
    "shape", "radius_m", "size_m",  "keyframes", "driven",   "load",     "half_length_m",    "file",
    "scale", "free",     "mass_kg", "density",   "groups",   "mask",     "self_contact"};

/// Bits, of which bodies need one in common.
CollisionFilter parse_filter(TomlTable& entry) {
  constexpr std::int64_t most = std::numeric_limits<std::uint32_t>::max();
  CollisionFilter filter;
  filter.groups = static_cast<std::uint32_t>(entry.integer("groups", 0, most).value_or(filter.groups));
  filter.mask = static_cast<std::uint32_t>(entry.integer("mask", 0, most).value_or(filter.mask));
  return filter;
}

SceneSoftBody parse_soft_body(TomlTable& entry) {
  SceneSoftBody body;
  entry.require("asset", "the .souple file, relative to the scene");
  body.asset = entry.text("asset").value_or("");
  body.description.pose = parse_pose(entry);
  body.description.velocity_m_s = entry.point("velocity", speed_range).value_or(Point{});
  body.description.angular_velocity_rad_s =
      entry.point("angular_velocity", speed_range).value_or(Point{});
  body.description.fixed_set = entry.plain_name("fixed").value_or("");
  body.description.driven = parse_driven(entry);
  body.description.filter = parse_filter(entry);
  body.description.self_contact = entry.flag("self_contact").value_or(false);
  body.loads = parse_loads(entry);
  return body;
}

RigidMeshFile parse_mesh_file(TomlTable& entry) {
  RigidMeshFile mesh;
  entry.require("file", "a closed surface, relative to the scene");
  mesh.file = entry.text("file").value_or("");
  if (entry.has("scale") && entry.has("size_m"))
    entry.refuse(IssueCode::usage_conflict, "a scale and a size were given", "scale");
  mesh.scale = entry.number("scale", {1e-9, 1e9}).value_or(1);
  mesh.size_m = entry.number("size_m", length_range).value_or(0);
  return mesh;
}

void parse_shape(TomlTable& entry, SceneRigidBody& body) {
  RigidShape& shape = body.description.shape;
  entry.require("shape", "plane, sphere, box, capsule or mesh");
  const std::string kind = entry.choice("shape", shape_kinds).value_or("plane");
  if (kind == "sphere" || kind == "capsule") {
    shape.kind = kind == "sphere" ? RigidShapeKind::sphere : RigidShapeKind::capsule;
    entry.require("radius_m", "of the " + kind);
    shape.radius_m = entry.number("radius_m", length_range).value_or(1);
  }
  if (kind == "capsule") {
    entry.require("half_length_m", "half of the segment on the local z axis, without the caps");
    shape.half_length_m = entry.number("half_length_m", length_range).value_or(1);
  } else if (kind == "box") {
    shape.kind = RigidShapeKind::box;
    entry.require("size_m", "the sides [x, y, z] of the box");
    shape.half_extents_m = entry.point("size_m", length_range).value_or(Point{1, 1, 1});
    for (double& side : shape.half_extents_m) side /= 2;
  } else if (kind == "mesh") {
    shape.kind = RigidShapeKind::mesh;
    body.mesh = parse_mesh_file(entry);
  }
}

std::optional<FreeRigidMotion> parse_free_motion(TomlTable& entry, const RigidBodyDescription& body) {
  if (!entry.flag("free").value_or(false)) return std::nullopt;
  if (body.shape.kind == RigidShapeKind::plane)
    entry.refuse(IssueCode::usage_conflict, "a plane has no end and no mass: it cannot be free",
                 "free");
  if (entry.has("keyframes"))
    entry.refuse(IssueCode::usage_conflict, "a free body follows no keyframes", "keyframes");
  FreeRigidMotion motion;
  if (entry.has("mass_kg") && entry.has("density"))
    entry.refuse(IssueCode::usage_conflict, "a mass and a density were given", "mass_kg");
  motion.mass_kg = entry.number("mass_kg", mass_range).value_or(0);
  motion.density_kg_m3 = entry.number("density", mass_range).value_or(motion.density_kg_m3);
  motion.velocity_m_s = entry.point("velocity", speed_range).value_or(Point{});
  motion.angular_velocity_rad_s = entry.point("angular_velocity", speed_range).value_or(Point{});
  return motion;
}

}  // namespace

SceneBody parse_body(TomlTable& entry, std::size_t number) {
  entry.require("kind", "soft or rigid");
  const std::string name = entry.plain_name("name").value_or("body" + std::to_string(number));
  if (entry.choice("kind", body_kinds).value_or("rigid") == "soft") {
    SceneSoftBody body = parse_soft_body(entry);
    body.description.name = name;
    return body;
  }
  SceneRigidBody body;
  body.description.name = name;
  if (!entry.has("kind")) {
    // Without a kind no other key can be judged: let them all pass, the missing kind is reported.
    for (const std::string_view key : body_keys) entry.has(key);
    return body;
  }
  parse_shape(entry, body);
  body.description.path = parse_path(entry);
  body.description.free = parse_free_motion(entry, body.description);
  body.description.filter = parse_filter(entry);
  return body;
}

}  // namespace souple
