// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/simulation_json.hpp"

#include "tools/commands/probe_json.hpp"

namespace souple {
namespace {

Json settings_json(const WorldSettings& s) {
  return {{"time_step_s", s.time_step_s},
          {"integrator", integrator_name(s.integrator)},
          {"rotation_method", rotation_method_name(s.rotation_method)},
          {"gravity_m_s2", s.gravity_m_s2},
          {"friction", s.friction},
          {"alarm_distance_m", s.alarm_distance_m},
          {"contact_method", contact_method_name(s.contact_method)},
          {"feed_forward_forces", s.feed_forward_forces},
          {"contact_tolerance", s.contact_solver.tolerance},
          {"contact_max_sweeps", s.contact_solver.max_sweeps},
          {"contact_penetration_m", s.contact_solver.penetration_m},
          {"contact_passes", s.contact_passes},
          {"penalty_stiffness_n_m", s.penalty_stiffness_n_m},
          {"sleep_after_s", s.sleep_after_s},
          {"sleep_speed", s.sleep_speed},
          {"solver", solver_name(s.free_motion.solver)},
          {"solver_tolerance", s.free_motion.tolerance},
          {"solver_unconverged",
           s.free_motion.unconverged == UnconvergedStep::refuse ? "refuse" : "keep_best"},
          {"solver_max_iterations", s.free_motion.max_iterations}};
}

Json assets_json(const std::vector<AssetUse>& assets) {
  Json list = Json::array();
  for (const AssetUse& use : assets)
    list.push_back({{"file", use.file.filename().string()},
                    {"file_bytes", use.file_bytes},
                    {"bytes_read", use.bytes_read},
                    {"resident_bytes", use.resident_bytes},
                    {"compliances", use.compliances}});
  return list;
}

Json bodies_json(const Scene& scene, const SceneWorld& built) {
  Json list = Json::array();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const bool soft = built.world.is_soft(built.bodies[i]);
    Json body = {{"name", scene_body_name(scene.bodies[i])}, {"kind", soft ? "soft" : "rigid"}};
    if (soft) {
      body["node_count"] = built.world.positions(built.bodies[i]).size();
      body["solver"] = solver_name(built.world.solver(built.bodies[i]));
    } else {
      const Pose pose = built.world.rigid_pose(built.bodies[i]);
      body["free"] = std::get<SceneRigidBody>(scene.bodies[i]).description.free.has_value();
      body["position_m"] = pose.translation;
      body["quaternion"] = pose.rotation;
      body["velocity_m_s"] = built.world.rigid_velocity(built.bodies[i]);
      body["angular_velocity_rad_s"] = built.world.rigid_angular_velocity(built.bodies[i]);
    }
    list.push_back(std::move(body));
  }
  return list;
}

Json times_json(const SimulationReport& r) {
  Json phases = Json::object();
  for (const PhaseStatistics& phase : r.phases)
    phases[phase.phase] = {
        {"sum_s", phase.sum_s}, {"median_s", phase.median_s}, {"p95_s", phase.p95_s}};
  return {{"steps_per_s", r.steps_per_s}, {"phases", phases}};
}

Json worst_json(const Worst& worst) { return {{"value", worst.value}, {"step", worst.step}}; }

Json laws_json(const SimulationReport& r) {
  return {{"worst_penetration_m", worst_json(r.penetration_m)},
          {"worst_surface_depth_m", worst_json(r.surface_depth_m)},
          {"cone_violation", worst_json(r.cone_violation)},
          {"joint_error_m", worst_json(r.joint_error_m)},
          {"contact_residual", worst_json(r.contact_residual)},
          {"contact_sweeps", worst_json(r.contact_sweeps)},
          {"free_motion_residual", worst_json(r.free_motion_residual)},
          {"unconverged_count", worst_json(r.unconverged_count)}};
}

Json events_json(const EventCounts& events) {
  return {{"begin", events.begin}, {"persist", events.persist}, {"end", events.end}};
}

Json step_json(const StepReport& r, const EventCounts& events) {
  return {{"contact_count", r.contact_count},
          {"active_count", r.active_count},
          {"contact_events", events_json(events)},
          {"island_count", r.island_count},
          {"sleeping_count", r.sleeping_count},
          {"contact_sweeps", r.contact_sweeps},
          {"contact_residual", r.contact_residual},
          {"free_motion_iterations", r.free_motion_iterations},
          {"free_motion_residual", r.free_motion_residual},
          {"unconverged_count", r.unconverged_count},
          {"penetration_m", r.worst_penetration_m},
          {"surface_depth_m", r.worst_surface_depth_m},
          {"joint_error_m", r.worst_joint_error_m},
          {"cone_violation", r.cone_violation},
          {"kinetic_energy_j", r.kinetic_energy_j},
          {"elastic_energy_j", r.elastic_energy_j},
          {"potential_energy_j", r.potential_energy_j},
          {"load_work_j", r.load_work_j},
          {"lost_energy_j", r.lost_energy_j},
          {"linear_momentum_kg_m_s", r.linear_momentum_kg_m_s},
          {"angular_momentum_kg_m2_s", r.angular_momentum_kg_m2_s}};
}

Json samples_json(const SimulationReport& r) {
  Json samples = Json::array();
  for (const SimulationSample& sample : r.samples) {
    Json row = {{"step", sample.step}, {"time_s", sample.time_s}};
    row.update(step_json(sample.report, sample.events));
    samples.push_back(std::move(row));
  }
  return samples;
}

}  // namespace

Json simulation_json(const Scene& scene, const SceneWorld& built, const SimulationReport& r,
                     const std::string& scene_file) {
  Json document = schema_header("simulate");
  document["schema_version"] = 2;  // 2: probes
  document["scene"] = std::filesystem::path(scene_file).filename().string();
  document["outcome"] = r.failure ? "failed" : r.interrupted ? "interrupted" : "done";
  document["issue"] = r.failure ? issue_json(*r.failure) : Json(nullptr);
  document["steps_asked"] = r.steps_asked;
  document["steps_done"] = r.steps_done;
  document["simulated_s"] = r.simulated_s;
  document["frame_count"] = r.frame_count;
  document["settings"] = settings_json(scene.world);
  document["assets"] = assets_json(built.assets);
  document["bodies"] = bodies_json(scene, built);
  document["times"] = times_json(r);
  document["contacts"] = {{"largest_count", r.largest_contact_count},
                          {"mean_count", r.mean_contact_count},
                          {"events", events_json(r.events)},
                          {"force_on_soft_bodies_n", r.contact_force_n},
                          {"soft_mass_kg", r.soft_mass_kg}};
  document["laws"] = laws_json(r);
  document["last_step"] = step_json(r.last, r.last_events);
  document["probes"] = probes_json(r.probes);
  document["sample_stride"] = r.sample_stride;
  document["samples"] = samples_json(r);
  document["state_hash"] = r.state_hash;
  return document;
}

}  // namespace souple
