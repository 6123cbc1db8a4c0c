// SPDX-License-Identifier: MIT
// Worlds, their steps, and their state as a whole.
#include "runtime/c_api/internal/buffers.hpp"
#include "runtime/c_api/internal/convert.hpp"
#include "runtime/c_api/internal/handles.hpp"

namespace souple::c_api {
namespace {

souple_world_settings default_settings() {
  const WorldSettings s;
  souple_world_settings made{};
  made.integrator = static_cast<std::int32_t>(s.integrator);
  made.time_step_s = s.time_step_s;
  made.gravity_m_s2 = from_point(s.gravity_m_s2);
  made.friction = s.friction;
  made.alarm_distance_m = s.alarm_distance_m;
  made.contact_method = static_cast<std::int32_t>(s.contact_method);
  made.rotation_method = static_cast<std::int32_t>(s.rotation_method);
  made.feed_forward_forces = s.feed_forward_forces;
  made.contact_passes = s.contact_passes;
  made.penalty_stiffness_n_m = s.penalty_stiffness_n_m;
  made.sleep_after_s = s.sleep_after_s;
  made.sleep_speed_sides_s = s.sleep_speed;
  made.contact_tolerance = s.contact_solver.tolerance;
  made.contact_max_sweeps = s.contact_solver.max_sweeps;
  made.contact_penetration_m = s.contact_solver.penetration_m;
  made.solver = static_cast<std::int32_t>(s.free_motion.solver);
  made.free_motion_tolerance = s.free_motion.tolerance;
  made.free_motion_max_iterations = s.free_motion.max_iterations;
  made.unconverged = static_cast<std::int32_t>(s.free_motion.unconverged);
  made.measure_laws = s.measure_laws;
  return made;
}

Status set_enums(const souple_world_settings& from, WorldSettings& to) {
  if (auto status = to_enum(from.integrator, Integrator::explicit_euler, "integrator", to.integrator);
      !status)
    return status;
  if (auto status =
          to_enum(from.contact_method, ContactMethod::penalty, "contact_method", to.contact_method);
      !status)
    return status;
  if (auto status = to_enum(from.rotation_method, RotationMethod::gram_schmidt, "rotation_method",
                            to.rotation_method);
      !status)
    return status;
  if (auto status =
          to_enum(from.solver, SolverKind::warped_multigrid_pcg, "solver", to.free_motion.solver);
      !status)
    return status;
  return to_enum(from.unconverged, UnconvergedStep::refuse, "unconverged", to.free_motion.unconverged);
}

Result<WorldSettings> to_settings(const souple_world_settings* given) {
  WorldSettings settings;
  if (!given) return settings;
  const auto read = read_struct(given, default_settings(), "settings");
  if (!read) return read.issue();
  if (auto status = check_reserved(read->reserved); !status) return status.issue();
  if (auto status = set_enums(*read, settings); !status) return status.issue();
  settings.time_step_s = read->time_step_s;
  settings.gravity_m_s2 = to_point(read->gravity_m_s2);
  settings.friction = read->friction;
  settings.alarm_distance_m = read->alarm_distance_m;
  settings.feed_forward_forces = read->feed_forward_forces != 0;
  settings.contact_passes = read->contact_passes;
  settings.penalty_stiffness_n_m = read->penalty_stiffness_n_m;
  settings.sleep_after_s = read->sleep_after_s;
  settings.sleep_speed = read->sleep_speed_sides_s;
  settings.contact_solver = {read->contact_tolerance, read->contact_max_sweeps,
                             read->contact_penetration_m};
  settings.free_motion.tolerance = read->free_motion_tolerance;
  settings.free_motion.max_iterations = read->free_motion_max_iterations;
  settings.measure_laws = read->measure_laws != 0;
  return settings;
}

souple_step_report from_report(const StepReport& r) {
  souple_step_report out{};
  out.contact_sweeps = r.contact_sweeps;
  out.contact_count = r.contact_count;
  out.active_count = r.active_count;
  out.uncovered_count = r.uncovered_count;
  out.island_count = r.island_count;
  out.sleeping_count = r.sleeping_count;
  out.contact_residual = r.contact_residual;
  out.free_motion_residual = r.free_motion_residual;
  out.free_motion_iterations = r.free_motion_iterations;
  out.unconverged_count = r.unconverged_count;
  out.free_motion_s = r.times.free_motion_s;
  out.collision_s = r.times.collision_s;
  out.compliance_s = r.times.compliance_s;
  out.contact_solve_s = r.times.contact_solve_s;
  out.correction_s = r.times.correction_s;
  out.total_s = r.times.total_s;
  out.worst_penetration_m = r.worst_penetration_m;
  out.worst_surface_depth_m = r.worst_surface_depth_m;
  out.worst_joint_error_m = r.worst_joint_error_m;
  out.cone_violation = r.cone_violation;
  out.kinetic_energy_j = r.kinetic_energy_j;
  out.elastic_energy_j = r.elastic_energy_j;
  out.potential_energy_j = r.potential_energy_j;
  out.load_work_j = r.load_work_j;
  out.lost_energy_j = r.lost_energy_j;
  out.linear_momentum_kg_m_s = from_point(r.linear_momentum_kg_m_s);
  out.angular_momentum_kg_m2_s = from_point(r.angular_momentum_kg_m2_s);
  return out;
}

// How the application's threads come back into one of our jobs.
extern "C" void run_one_job(void* job_context, size_t index) {
  (*static_cast<const std::function<void(std::size_t)>*>(job_context))(index);
}

RunJobs to_run_jobs(souple_run_jobs run_jobs, void* user) {
  if (!run_jobs) return {};
  return [run_jobs, user](std::size_t count, const std::function<void(std::size_t)>& job) {
    run_jobs(user, count, &run_one_job, const_cast<std::function<void(std::size_t)>*>(&job));
  };
}

}  // namespace
}  // namespace souple::c_api

using namespace souple;
using namespace souple::c_api;

extern "C" {

souple_status souple_world_settings_init(souple_world_settings* settings, size_t struct_size) {
  return guarded([&] { return init_struct(settings, struct_size, default_settings(), "settings"); });
}

souple_status souple_world_create(const souple_world_settings* settings, souple_world** world) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    const auto read = to_settings(settings);
    if (!read) return read.issue();
    auto made = World::create(*read);
    if (!made) return made.issue();
    *world = new souple_world{std::move(*made)};
    return {};
  });
}

void souple_world_destroy(souple_world* world) { delete world; }

souple_status souple_world_run_jobs_with(souple_world* world, souple_run_jobs run_jobs, void* user) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    world->world.run_jobs_with(to_run_jobs(run_jobs, user));
    return {};
  });
}

souple_status souple_step_report_init(souple_step_report* report, size_t struct_size) {
  return guarded([&] { return init_struct(report, struct_size, {}, "report"); });
}

souple_status souple_world_step(souple_world* world, souple_step_report* report) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    if (report)  // a report that cannot be written must not cost a step
      if (auto status =
              check_struct_size(report->struct_size, first_size<souple_step_report>, "report");
          !status)
        return status;
    const auto done = world->world.step();
    if (!done) return done.issue();
    return report ? write_struct(report, from_report(*done), "report") : Status();
  });
}

double souple_world_time_s(const souple_world* world) { return world ? world->world.time_s() : 0; }

souple_status souple_world_copy_state(souple_world* world, const souple_world* other) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}, {other, "other"}}); !status) return status;
    return world->world.copy_state(other->world);
  });
}

souple_status souple_world_snapshot(const souple_world* world, void* bytes, size_t capacity,
                                    size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}}); !status) return status;
    const std::vector<std::byte> snapshot = world->world.snapshot();
    return fill(static_cast<std::byte*>(bytes), capacity, needed, snapshot.size(),
                [&](std::size_t i) { return snapshot[i]; });
  });
}

souple_status souple_world_restore(souple_world* world, const void* bytes, size_t size) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}, {bytes, "bytes"}}); !status) return status;
    return world->world.restore({static_cast<const std::byte*>(bytes), size});
  });
}

}  // extern "C"
