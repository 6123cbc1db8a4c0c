// SPDX-License-Identifier: MIT
// What acts on the bodies of a world from outside: loads, joints, grabs; and picking where.
#include <cmath>

#include "runtime/c_api/internal/buffers.hpp"
#include "runtime/c_api/internal/convert.hpp"
#include "runtime/c_api/internal/handles.hpp"

namespace souple::c_api {
namespace {

souple_load_description default_load() {
  souple_load_description made{};
  made.triangle = -1;
  return made;
}

souple_joint_description default_joint() {
  const JointDescription d;
  souple_joint_description made{};
  made.kind = static_cast<std::int32_t>(d.kind);
  made.body_b = SOUPLE_NO_BODY;
  made.axis = from_point(d.axis);
  made.arm_m = d.arm_m;
  made.reach_m = d.reach_m;
  return made;
}

souple_load pack(const LoadId& load) { return souple_load{load.body} << 32 | load.index; }
LoadId unpack(souple_load load) {
  return {static_cast<std::uint32_t>(load >> 32), static_cast<std::uint32_t>(load)};
}

Status set_places(const souple_load_description& given, LoadDescription& made) {
  if (auto status = check_array(given.nodes, given.node_count, "nodes"); !status) return status;
  if (auto status = check_array(given.triangles, given.triangle_count, "triangles"); !status)
    return status;
  made.nodes.assign(given.nodes, given.nodes + given.node_count);
  made.triangle = given.triangle;
  made.weight = {given.weight[0], given.weight[1], given.weight[2]};
  made.triangles.assign(given.triangles, given.triangles + given.triangle_count);
  return {};
}

Result<LoadDescription> to_load(const souple_load_description& given) {
  LoadDescription made;
  auto name = to_text(given.name, "name");
  if (!name) return name.issue();
  made.name = std::move(*name);
  if (auto status = to_enum(given.kind, LoadKind::pressure, "kind", made.kind); !status)
    return status.issue();
  made.follows = given.follows != 0;
  if (auto status = set_places(given, made); !status) return status.issue();
  if (auto status = check_array(given.course, given.course_count, "course"); !status)
    return status.issue();
  for (std::size_t k = 0; k < given.course_count; ++k) {
    const souple_load_keyframe& keyframe = given.course[k];
    made.course.push_back({keyframe.time_s, to_point(keyframe.vector), keyframe.pressure_pa});
  }
  return made;
}

Result<JointDescription> to_joint(const souple_joint_description& given) {
  JointDescription made;
  if (auto status = check_reserved(given.reserved); !status) return status.issue();
  auto name = to_text(given.name, "name");
  if (!name) return name.issue();
  made.name = std::move(*name);
  if (auto status = to_enum(given.kind, JointKind::weld, "kind", made.kind); !status)
    return status.issue();
  made.body_a = {given.body_a};
  if (given.body_b != SOUPLE_NO_BODY) made.body_b = BodyId{given.body_b};
  made.point_m = to_point(given.point_m);
  made.axis = to_point(given.axis);
  made.arm_m = given.arm_m;
  made.reach_m = given.reach_m;
  made.collide = given.collide != 0;
  return made;
}

}  // namespace
}  // namespace souple::c_api

using namespace souple;
using namespace souple::c_api;

extern "C" {

souple_status souple_load_description_init(souple_load_description* description, size_t struct_size) {
  return guarded([&] { return init_struct(description, struct_size, default_load(), "description"); });
}

souple_status souple_world_add_load(souple_world* world, souple_body soft_body,
                                    const souple_load_description* description, souple_load* load) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}, {load, "load"}}); !status) return status;
    if (auto status = check_soft(*world, soft_body); !status) return status;
    const auto read = read_struct(description, default_load(), "description");
    if (!read) return read.issue();
    const auto made = to_load(*read);
    if (!made) return made.issue();
    const auto added = world->world.add_load({soft_body}, *made);
    if (!added) return added.issue();
    *load = pack(*added);
    return {};
  });
}

souple_status souple_world_set_load(souple_world* world, souple_load load, souple_vec3 vector,
                                    double pressure_pa) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    return world->world.set_load(unpack(load), {0, to_point(vector), pressure_pa});
  });
}

souple_status souple_joint_description_init(souple_joint_description* description, size_t struct_size) {
  return guarded([&] { return init_struct(description, struct_size, default_joint(), "description"); });
}

souple_status souple_world_add_joint(souple_world* world, const souple_joint_description* description,
                                     souple_joint* joint) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}, {joint, "joint"}}); !status) return status;
    const auto read = read_struct(description, default_joint(), "description");
    if (!read) return read.issue();
    const auto made = to_joint(*read);
    if (!made) return made.issue();
    const auto added = world->world.add_joint(*made);
    if (!added) return added.issue();
    *joint = added.value().index;
    return {};
  });
}

souple_status souple_world_grab(souple_world* world, souple_body body, souple_vec3 point_m,
                                double radius_m, int32_t most_nodes, souple_grab* grab) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}, {grab, "grab"}}); !status) return status;
    if (auto status = check_body(*world, body); !status) return status;
    constexpr std::int32_t most = 10000;
    if (most_nodes < 1 || most_nodes > most)
      return invalid(std::to_string(most_nodes) + " is outside [1, 10000]", "most_nodes");
    const auto held = world->world.grab({{body}, to_point(point_m), radius_m, most_nodes});
    if (!held) return held.issue();
    *grab = held.value().index;
    return {};
  });
}

souple_status souple_world_move_grab(souple_world* world, souple_grab grab, souple_pose pose) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    return world->world.move_grab({grab}, to_pose(pose));
  });
}

souple_status souple_world_release(souple_world* world, souple_grab grab) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    return world->world.release({grab});
  });
}

souple_status souple_world_pick(const souple_world* world, souple_vec3 origin_m, souple_vec3 direction,
                                double reach_m, souple_pick_hit* hit) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}, {hit, "hit"}}); !status) return status;
    if (!is_finite(origin_m)) return invalid("a point that is not finite", "origin_m");
    const bool points = direction.x != 0 || direction.y != 0 || direction.z != 0;
    if (!is_finite(direction) || !points) return invalid("a direction that is none", "direction");
    if (!(reach_m > 0)) return invalid("a reach is larger than 0", "reach_m");
    *hit = {SOUPLE_NO_BODY, -1, 0, {}, {}};
    if (const auto found = world->world.pick(to_point(origin_m), to_point(direction), reach_m))
      *hit = {found->body.index, found->node, found->distance_m, from_point(found->point_m),
              from_point(found->normal)};
    return {};
  });
}

}  // extern "C"
