// SPDX-License-Identifier: MIT
// Bodies of a world, and the rules between them.
#include <limits>

#include "runtime/c_api/internal/buffers.hpp"
#include "runtime/c_api/internal/convert.hpp"
#include "runtime/c_api/internal/handles.hpp"

namespace souple::c_api {

Status check_body(const souple_world& world, souple_body body) {
  if (body < world.world.body_count()) return {};
  return make_issue(IssueCode::api_no_such_object,
                    "body " + std::to_string(body) + " of " + std::to_string(world.world.body_count()),
                    "body");
}

Status check_soft(const souple_world& world, souple_body body) {
  if (auto status = check_body(world, body); !status) return status;
  if (world.world.is_soft({body})) return {};
  return make_issue(IssueCode::api_no_such_object, "a rigid body where a soft one is needed",
                    world.world.body_name({body}));
}

Status check_rigid(const souple_world& world, souple_body body) {
  if (auto status = check_body(world, body); !status) return status;
  if (!world.world.is_soft({body})) return {};
  return make_issue(IssueCode::api_no_such_object, "a soft body where a rigid one is needed",
                    world.world.body_name({body}));
}

namespace {

souple_soft_body_description default_soft() {
  souple_soft_body_description made{};
  made.pose = identity_pose;
  made.collision_groups = CollisionFilter{}.groups;
  made.collision_mask = CollisionFilter{}.mask;
  return made;
}

souple_rigid_body_description default_rigid() {
  souple_rigid_body_description made{};
  made.pose = identity_pose;
  made.density_kg_m3 = FreeRigidMotion{}.density_kg_m3;
  made.collision_groups = CollisionFilter{}.groups;
  made.collision_mask = CollisionFilter{}.mask;
  return made;
}

Result<std::vector<DrivenSet>> to_driven(const souple_driven_set* sets, std::size_t count) {
  if (auto status = check_array(sets, count, "driven"); !status) return status.issue();
  std::vector<DrivenSet> driven;
  for (std::size_t k = 0; k < count; ++k) {
    auto name = to_text(sets[k].name, "driven.name");
    if (!name) return name.issue();
    auto path = to_path(sets[k].path, sets[k].path_count, "driven.path");
    if (!path) return path.issue();
    driven.push_back({std::move(*name), std::move(*path)});
  }
  return driven;
}

Result<SoftBodyDescription> to_soft(const souple_soft_body_description& given) {
  SoftBodyDescription made;
  auto name = to_text(given.name, "name");
  if (!name) return name.issue();
  auto fixed_set = to_text(given.fixed_set, "fixed_set");
  if (!fixed_set) return fixed_set.issue();
  auto driven = to_driven(given.driven, given.driven_count);
  if (!driven) return driven.issue();
  made.name = std::move(*name);
  made.pose = to_pose(given.pose);
  made.velocity_m_s = to_point(given.velocity_m_s);
  made.angular_velocity_rad_s = to_point(given.angular_velocity_rad_s);
  made.fixed_set = std::move(*fixed_set);
  made.driven = std::move(*driven);
  made.filter = {given.collision_groups, given.collision_mask};
  made.self_contact = given.self_contact != 0;
  return made;
}

Status set_motion(const souple_rigid_body_description& given, RigidBodyDescription& made) {
  if (auto status = check_number(given.motion, SOUPLE_MOTION_FREE, "motion"); !status) return status;
  if (given.motion == SOUPLE_MOTION_DRIVEN) {
    auto path = to_path(given.path, given.path_count, "path");
    if (!path) return path.issue();
    made.path = std::move(*path);
    return {};
  }
  if (given.path_count != 0) return invalid("only a driven body has a path", "path_count");
  made.path = {{0, to_pose(given.pose)}};
  if (given.motion == SOUPLE_MOTION_FREE)
    made.free = {given.mass_kg, given.density_kg_m3, to_point(given.velocity_m_s),
                 to_point(given.angular_velocity_rad_s)};
  return {};
}

Result<RigidBodyDescription> to_rigid(const souple_rigid_body_description& given) {
  RigidBodyDescription made;
  if (auto status = check_reserved(given.reserved); !status) return status.issue();
  auto name = to_text(given.name, "name");
  if (!name) return name.issue();
  made.name = std::move(*name);
  if (auto status = to_enum(given.shape, RigidShapeKind::mesh, "shape", made.shape.kind); !status)
    return status.issue();
  made.shape.radius_m = given.radius_m;
  made.shape.half_extents_m = to_point(given.half_extents_m);
  made.shape.half_length_m = given.half_length_m;
  if (given.mesh) made.shape.mesh = given.mesh->mesh;
  if (auto status = set_motion(given, made); !status) return status.issue();
  made.filter = {given.collision_groups, given.collision_mask};
  return made;
}

}  // namespace
}  // namespace souple::c_api

using namespace souple;
using namespace souple::c_api;

extern "C" {

souple_status souple_soft_body_description_init(souple_soft_body_description* description,
                                                size_t struct_size) {
  return guarded([&] { return init_struct(description, struct_size, default_soft(), "description"); });
}

souple_status souple_world_add_soft_body(souple_world* world, const souple_asset* asset,
                                         const souple_soft_body_description* description,
                                         souple_body* body) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}, {asset, "asset"}, {body, "body"}}); !status)
      return status;
    const auto read = read_struct(description, default_soft(), "description");
    if (!read) return read.issue();
    const auto made = to_soft(*read);
    if (!made) return made.issue();
    if (const VisualSurface* visual = asset->body->visual())
      if (world->vertices.size() < visual->vertex_count())
        world->vertices.resize(visual->vertex_count());
    const auto added = world->world.add_soft_body(asset->body, *made);
    if (!added) return added.issue();
    *body = added.value().index;
    return {};
  });
}

souple_status souple_rigid_body_description_init(souple_rigid_body_description* description,
                                                 size_t struct_size) {
  return guarded([&] { return init_struct(description, struct_size, default_rigid(), "description"); });
}

souple_status souple_world_add_rigid_body(souple_world* world,
                                          const souple_rigid_body_description* description,
                                          souple_body* body) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}, {body, "body"}}); !status) return status;
    const auto read = read_struct(description, default_rigid(), "description");
    if (!read) return read.issue();
    const auto made = to_rigid(*read);
    if (!made) return made.issue();
    const auto added = world->world.add_rigid_body(*made);
    if (!added) return added.issue();
    *body = added.value().index;
    return {};
  });
}

size_t souple_world_body_count(const souple_world* world) {
  return world ? world->world.body_count() : 0;
}

const char* souple_world_body_name(const souple_world* world, souple_body body) {
  if (!world || body >= world->world.body_count()) return nullptr;
  return world->world.body_name({body}).c_str();
}

int32_t souple_world_is_soft(const souple_world* world, souple_body body) {
  return world && body < world->world.body_count() && world->world.is_soft({body});
}

souple_status souple_world_solver(const souple_world* world, souple_body soft_body, int32_t* solver) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}, {solver, "solver"}}); !status) return status;
    if (auto status = check_soft(*world, soft_body); !status) return status;
    *solver = static_cast<std::int32_t>(world->world.solver({soft_body}));
    return {};
  });
}

souple_status souple_world_set_pair(souple_world* world, souple_body a, souple_body b, int32_t collides,
                                    double friction, double restitution) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    for (const souple_body body : {a, b})
      if (auto status = check_body(*world, body); !status) return status;
    return world->world.set_pair({a}, {b}, {friction, collides != 0, restitution});
  });
}

souple_status souple_world_wake(souple_world* world, souple_body body) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    if (auto status = check_body(*world, body); !status) return status;
    world->world.wake({body});
    return {};
  });
}

int32_t souple_world_is_asleep(const souple_world* world, souple_body body) {
  return world && body < world->world.body_count() && world->world.is_asleep({body});
}

souple_status souple_world_set_soft_state(souple_world* world, souple_body soft_body,
                                          const souple_vec3* positions_m,
                                          const souple_vec3* velocities_m_s, size_t count) {
  return guarded([&]() -> Status {
    if (auto status =
            need({{world, "world"}, {positions_m, "positions_m"}, {velocities_m_s, "velocities_m_s"}});
        !status)
      return status;
    if (auto status = check_soft(*world, soft_body); !status) return status;
    return world->world.set_state({soft_body}, as_points(positions_m, count),
                                  as_points(velocities_m_s, count));
  });
}

souple_status souple_world_set_rigid_state(souple_world* world, souple_body rigid_body,
                                           souple_pose pose, souple_vec3 velocity_m_s,
                                           souple_vec3 angular_velocity_rad_s) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    if (auto status = check_rigid(*world, rigid_body); !status) return status;
    return world->world.set_rigid_state({rigid_body}, to_pose(pose), to_point(velocity_m_s),
                                        to_point(angular_velocity_rad_s));
  });
}

}  // extern "C"
