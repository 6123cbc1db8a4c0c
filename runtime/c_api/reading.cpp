// SPDX-License-Identifier: MIT
// What a step has made, into the caller's buffers.
#include "runtime/c_api/internal/buffers.hpp"
#include "runtime/c_api/internal/convert.hpp"
#include "runtime/c_api/internal/handles.hpp"

namespace souple::c_api {
namespace {

/// Hands `write` the room for `count` vectors of three numbers, if it may be filled.
template <class Write>
Status fill_xyz(const void* buffer, std::size_t capacity, std::size_t* needed, std::size_t count,
                Write&& write) {
  const auto may = may_fill(buffer, capacity, needed, count);
  if (!may) return may.issue();
  if (*may) write();
  return {};
}

void write_f32(const Point& point, float* xyz) {
  for (std::size_t axis = 0; axis < 3; ++axis) xyz[axis] = static_cast<float>(point[axis]);
}

Status check_reader(const souple_world* world, souple_body soft_body) {
  if (auto status = need({{world, "world"}}); !status) return status;
  return check_soft(*world, soft_body);
}

Result<const VisualSurface*> visual_of(const souple_world* world, souple_body soft_body) {
  if (auto status = check_reader(world, soft_body); !status) return status.issue();
  const VisualSurface* visual = world->world.asset({soft_body}).visual();
  if (visual) return visual;
  return make_issue(IssueCode::asset_missing_part, "no surface to be shown was loaded",
                    world->world.body_name({soft_body}));
}

souple_contact from_contact(const ContactRecord& c) {
  return {c.body_a.index,       c.body_b.index,        from_point(c.point_m),
          from_point(c.normal), from_point(c.force_n), c.gap_m};
}

souple_contact_event from_event(const ContactEvent& e) {
  return {static_cast<std::int32_t>(e.kind), e.contact_count, e.body_a.index, e.body_b.index,
          from_point(e.force_n)};
}

}  // namespace
}  // namespace souple::c_api

using namespace souple;
using namespace souple::c_api;

extern "C" {

souple_status souple_world_positions(const souple_world* world, souple_body soft_body,
                                     souple_vec3* positions_m, size_t capacity, size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = check_reader(world, soft_body); !status) return status;
    const auto all = world->world.positions({soft_body});
    return fill(positions_m, capacity, needed, all.size(),
                [&](std::size_t i) { return from_point(all[i]); });
  });
}

souple_status souple_world_velocities(const souple_world* world, souple_body soft_body,
                                      souple_vec3* velocities_m_s, size_t capacity, size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = check_reader(world, soft_body); !status) return status;
    const auto all = world->world.velocities({soft_body});
    return fill(velocities_m_s, capacity, needed, all.size(),
                [&](std::size_t i) { return from_point(all[i]); });
  });
}

souple_status souple_world_surface_positions(const souple_world* world, souple_body soft_body,
                                             souple_vec3* positions_m, size_t capacity,
                                             size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = check_reader(world, soft_body); !status) return status;
    const auto all = world->world.positions({soft_body});
    const auto nodes = world->world.asset({soft_body}).surface().nodes();
    return fill(positions_m, capacity, needed, nodes.size(),
                [&](std::size_t i) { return from_point(all[std::size_t(nodes[i])]); });
  });
}

souple_status souple_world_surface_positions_f32(const souple_world* world, souple_body soft_body,
                                                 float* xyz_m, size_t capacity, size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = check_reader(world, soft_body); !status) return status;
    const auto all = world->world.positions({soft_body});
    const auto nodes = world->world.asset({soft_body}).surface().nodes();
    return fill_xyz(xyz_m, capacity, needed, nodes.size(), [&] {
      for (std::size_t i = 0; i < nodes.size(); ++i)
        write_f32(all[std::size_t(nodes[i])], xyz_m + 3 * i);
    });
  });
}

souple_status souple_world_visual_positions(const souple_world* world, souple_body soft_body,
                                            souple_vec3* positions_m, size_t capacity, size_t* needed) {
  return guarded([&]() -> Status {
    const auto visual = visual_of(world, soft_body);
    if (!visual) return visual.issue();
    const std::size_t count = (*visual)->vertex_count();
    return fill_xyz(positions_m, capacity, needed, count, [&] {
      const std::span<Point> vertices(world->vertices.data(), count);
      (*visual)->positions(world->world.positions({soft_body}), vertices);
      for (std::size_t i = 0; i < count; ++i) positions_m[i] = from_point(vertices[i]);
    });
  });
}

souple_status souple_world_visual_positions_f32(const souple_world* world, souple_body soft_body,
                                                float* xyz_m, size_t capacity, size_t* needed) {
  return guarded([&]() -> Status {
    const auto visual = visual_of(world, soft_body);
    if (!visual) return visual.issue();
    const std::size_t count = (*visual)->vertex_count();
    return fill_xyz(xyz_m, capacity, needed, count, [&] {
      const std::span<Point> vertices(world->vertices.data(), count);
      (*visual)->positions(world->world.positions({soft_body}), vertices);
      for (std::size_t i = 0; i < count; ++i) write_f32(vertices[i], xyz_m + 3 * i);
    });
  });
}

souple_status souple_world_rigid_pose(const souple_world* world, souple_body rigid_body,
                                      souple_pose* pose) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}, {pose, "pose"}}); !status) return status;
    if (auto status = check_rigid(*world, rigid_body); !status) return status;
    *pose = from_pose(world->world.rigid_pose({rigid_body}));
    return {};
  });
}

souple_status souple_world_rigid_velocity(const souple_world* world, souple_body rigid_body,
                                          souple_vec3* velocity_m_s,
                                          souple_vec3* angular_velocity_rad_s) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    if (auto status = check_rigid(*world, rigid_body); !status) return status;
    if (velocity_m_s) *velocity_m_s = from_point(world->world.rigid_velocity({rigid_body}));
    if (angular_velocity_rad_s)
      *angular_velocity_rad_s = from_point(world->world.rigid_angular_velocity({rigid_body}));
    return {};
  });
}

souple_status souple_world_contacts(const souple_world* world, souple_contact* contacts,
                                    size_t capacity, size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    const std::vector<ContactRecord> all = world->world.contacts();
    return fill(contacts, capacity, needed, all.size(),
                [&](std::size_t i) { return from_contact(all[i]); });
  });
}

souple_status souple_world_contact_events(const souple_world* world, souple_contact_event* events,
                                          size_t capacity, size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    const auto all = world->world.contact_events();
    return fill(events, capacity, needed, all.size(),
                [&](std::size_t i) { return from_event(all[i]); });
  });
}

}  // extern "C"
