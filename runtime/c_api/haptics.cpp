// SPDX-License-Identifier: MIT
#include "runtime/haptics/haptic_channel.hpp"

#include <algorithm>
#include <memory>

#include "runtime/c_api/internal/buffers.hpp"
#include "runtime/c_api/internal/convert.hpp"
#include "runtime/c_api/internal/handles.hpp"

struct souple_haptic_channel {
  souple::HapticChannel channel;
  const souple_world* world;  ///< that holds the tool; looked at as a number only
};

namespace souple::c_api {
namespace {

souple_jaw_description default_jaw() {
  const JawDescription d;
  souple_jaw_description made{};
  made.shape = SOUPLE_SHAPE_SPHERE;
  made.hinge = identity_pose;
  made.axis = from_point(d.axis);
  made.mount = identity_pose;
  made.turn_per_opening = d.turn_per_opening;
  made.stiffness_n_m = d.coupling.stiffness_n_m;
  made.turn_stiffness_nm_rad = d.coupling.turn_stiffness_nm_rad;
  made.damping_n_s_m = d.coupling.damping_n_s_m;
  made.turn_damping_nm_s_rad = d.coupling.turn_damping_nm_s_rad;
  made.centre_m = from_point(d.coupling.centre_m);
  made.look_ahead_m = d.coupling.look_ahead_m;
  return made;
}

souple_tool_description default_tool() {
  souple_tool_description made{};
  made.pose = identity_pose;
  made.collision_groups = CollisionFilter{}.groups;
  made.collision_mask = CollisionFilter{}.mask;
  return made;
}

souple_haptic_settings default_haptics() {
  const HapticSettings s;
  souple_haptic_settings made{};
  made.max_sweeps = s.max_sweeps;
  made.contact_capacity = s.contact_capacity;
  made.tick_budget_s = s.tick_budget_s;
  made.residual_goal = s.residual_goal;
  made.hand_over_s = s.hand_over_s;
  made.hand_over_share = s.hand_over_share;
  made.dead_after_s = s.dead_after_s;
  made.fade_s = s.fade_s;
  made.credible_speed_m_s = s.credible_speed_m_s;
  made.credible_turn_rad_s = s.credible_turn_rad_s;
  made.recover_after_s = s.recover_after_s;
  made.reach_m = s.reach_m;
  made.lead_s = s.lead_s;
  made.device_rate_hz = s.limits.rate_hz;
  made.device_force_n = s.limits.force_n;
  made.device_torque_nm = s.limits.torque_nm;
  made.device_opening_nm = s.limits.opening_nm;
  made.device_force_slew_n_s = s.limits.force_slew_n_s;
  made.device_torque_slew_nm_s = s.limits.torque_slew_nm_s;
  made.device_has_opening = s.limits.has_opening;
  return made;
}

Result<JawDescription> to_jaw(const souple_jaw_description& given) {
  JawDescription made;
  if (auto status = to_enum(given.shape, RigidShapeKind::mesh, "jaws.shape", made.shape.kind); !status)
    return status.issue();
  if (made.shape.kind == RigidShapeKind::plane) return invalid("a jaw is no plane", "jaws.shape");
  made.shape.radius_m = given.radius_m;
  made.shape.half_extents_m = to_point(given.half_extents_m);
  made.shape.half_length_m = given.half_length_m;
  if (given.mesh) made.shape.mesh = given.mesh->mesh;
  made.hinge = to_pose(given.hinge);
  made.axis = to_point(given.axis);
  made.mount = to_pose(given.mount);
  made.turn_per_opening = given.turn_per_opening;
  made.coupling = {given.stiffness_n_m,         given.turn_stiffness_nm_rad, given.damping_n_s_m,
                   given.turn_damping_nm_s_rad, to_point(given.centre_m),    given.look_ahead_m};
  return made;
}

// The jaws lie one after another in the caller's version of the struct.
Result<std::vector<JawDescription>> to_jaws(const souple_jaw_description* jaws, std::size_t count) {
  if (count < 1 || count > most_jaws)
    return invalid("a tool has one jaw or two, not " + std::to_string(count), "jaw_count");
  if (auto status = need({{jaws, "jaws"}}); !status) return status.issue();
  const auto* bytes = reinterpret_cast<const std::byte*>(jaws);
  std::vector<JawDescription> made;
  for (std::size_t k = 0; k < count; ++k) {
    const auto* jaw =
        reinterpret_cast<const souple_jaw_description*>(bytes + k * std::size_t(jaws->struct_size));
    if (jaw->struct_size != jaws->struct_size)
      return make_issue(IssueCode::api_struct_size_invalid, "jaws of different sizes", "jaws");
    const auto read = read_struct(jaw, default_jaw(), "jaws");
    if (!read) return read.issue();
    auto one = to_jaw(*read);
    if (!one) return one.issue();
    made.push_back(std::move(*one));
  }
  return made;
}

Result<ToolDescription> to_tool(const souple_tool_description* given) {
  const auto read = read_struct(given, default_tool(), "tool");
  if (!read) return read.issue();
  if (auto status = check_reserved(read->reserved); !status) return status.issue();
  ToolDescription made;
  auto name = to_text(read->name, "name");
  if (!name) return name.issue();
  auto jaws = to_jaws(read->jaws, read->jaw_count);
  if (!jaws) return jaws.issue();
  made.name = std::move(*name);
  made.jaws = std::move(*jaws);
  made.pose = to_pose(read->pose);
  made.opening_rad = read->opening_rad;
  made.filter = {read->collision_groups, read->collision_mask};
  return made;
}

Result<HapticSettings> to_haptics(const souple_haptic_settings* given) {
  HapticSettings made;
  if (!given) return made;
  const auto read = read_struct(given, default_haptics(), "settings");
  if (!read) return read.issue();
  if (auto status = check_reserved(read->reserved); !status) return status.issue();
  made.contact_capacity = read->contact_capacity;
  made.tick_budget_s = read->tick_budget_s;
  made.residual_goal = read->residual_goal;
  made.max_sweeps = read->max_sweeps;
  made.hand_over_s = read->hand_over_s;
  made.hand_over_share = read->hand_over_share;
  made.dead_after_s = read->dead_after_s;
  made.fade_s = read->fade_s;
  made.credible_speed_m_s = read->credible_speed_m_s;
  made.credible_turn_rad_s = read->credible_turn_rad_s;
  made.recover_after_s = read->recover_after_s;
  made.reach_m = read->reach_m;
  made.lead_s = read->lead_s;
  made.limits = {read->device_rate_hz,         read->device_force_n,
                 read->device_torque_nm,       read->device_opening_nm,
                 read->device_force_slew_n_s,  read->device_torque_slew_nm_s,
                 read->device_has_opening != 0};
  return made;
}

// Made in a world of its own first, so that a refusal leaves no jaw in the caller's.
Status try_out(const ToolDescription& description, HapticSettings settings) {
  auto world = World::create({});
  if (!world) return world.issue();
  auto tool = Tool::create(*world, description);
  if (!tool) return tool.issue();
  if (settings.contact_capacity > 0 && settings.contact_capacity <= 4096) settings.contact_capacity = 1;
  const auto channel = HapticChannel::create(std::move(*tool), settings);
  return channel ? Status() : channel.issue();
}

Status check_world(const souple_haptic_channel& channel, const souple_world* world) {
  if (channel.world == world) return {};
  return make_issue(IssueCode::api_no_such_object, "the tool is in another world", "world");
}

souple_device_sample from_sample(const DeviceSample& s) {
  return {s.time_s, from_pose(s.pose), s.opening_rad};
}

souple_wrench from_wrench(const Wrench& w) {
  return {from_point(w.force_n), from_point(w.torque_nm), w.opening_nm};
}

static_assert(sizeof(souple_histogram::count) == sizeof(LogHistogram::count));

souple_histogram from_histogram(const LogHistogram& h) {
  souple_histogram made{h.lowest, h.ratio, {}};
  std::ranges::copy(h.count, made.count);
  return made;
}

souple_haptic_telemetry from_telemetry(const HapticTelemetry& t) {
  souple_haptic_telemetry made{};
  made.ticks = t.ticks;
  made.sweeps = t.sweeps;
  made.idle_ticks = t.idle_ticks;
  made.deadline_misses = t.deadline_misses;
  made.unconverged_ticks = t.unconverged_ticks;
  made.publications = t.publications;
  made.hand_overs = t.hand_overs;
  made.refused_not_finite = t.refused_not_finite;
  made.refused_jumps = t.refused_jumps;
  made.refused_clock = t.refused_clock;
  made.missing_samples = t.missing_samples;
  made.recoveries = t.recoveries;
  made.dead_ticks = t.dead_ticks;
  made.clamped_ticks = t.clamped_ticks;
  made.limited_ticks = t.limited_ticks;
  made.contacts_left_out = t.contacts_left_out;
  made.contacts = t.contacts;
  made.active_contacts = t.active_contacts;
  made.active_sum = t.active_sum;
  made.contact_sum = t.contact_sum;
  made.largest_force_n = t.largest_force_n;
  made.largest_hand_over_step_n = t.largest_hand_over_step_n;
  made.largest_step_n = t.largest_step_n;
  made.longest_silence_s = t.longest_silence_s;
  made.tick_time_s = from_histogram(t.tick_time_s);
  made.sweeps_per_tick = from_histogram(t.sweeps_per_tick);
  made.residual = from_histogram(t.residual);
  made.hand_over_step_n = from_histogram(t.hand_over_step_n);
  return made;
}

}  // namespace
}  // namespace souple::c_api

using namespace souple;
using namespace souple::c_api;

extern "C" {

souple_status souple_jaw_description_init(souple_jaw_description* description, size_t struct_size) {
  return guarded([&] { return init_struct(description, struct_size, default_jaw(), "description"); });
}

souple_status souple_tool_description_init(souple_tool_description* description, size_t struct_size) {
  return guarded([&] { return init_struct(description, struct_size, default_tool(), "description"); });
}

souple_status souple_haptic_settings_init(souple_haptic_settings* settings, size_t struct_size) {
  return guarded([&] { return init_struct(settings, struct_size, default_haptics(), "settings"); });
}

souple_status souple_haptic_channel_create(souple_world* world, const souple_tool_description* tool,
                                           const souple_haptic_settings* settings,
                                           souple_haptic_channel** channel) {
  return guarded([&]() -> Status {
    if (auto status = need({{world, "world"}, {tool, "tool"}, {channel, "channel"}}); !status)
      return status;
    const auto description = to_tool(tool);
    if (!description) return description.issue();
    const auto haptics = to_haptics(settings);
    if (!haptics) return haptics.issue();
    if (auto status = try_out(*description, *haptics); !status) return status;
    auto added = Tool::create(world->world, *description);
    if (!added) return added.issue();
    auto made = HapticChannel::create(std::move(*added), *haptics);
    if (!made) return made.issue();
    *channel = new souple_haptic_channel{std::move(*made), world};
    return {};
  });
}

void souple_haptic_channel_destroy(souple_haptic_channel* channel) { delete channel; }

souple_status souple_haptic_tool_bodies(const souple_haptic_channel* channel, souple_body* bodies,
                                        size_t capacity, size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = need({{channel, "channel"}}); !status) return status;
    const auto all = channel->channel.tool().bodies();
    return fill(bodies, capacity, needed, all.size(), [&](std::size_t i) { return all[i].index; });
  });
}

souple_status souple_haptic_begin_step(souple_haptic_channel* channel, souple_world* world) {
  return guarded([&]() -> Status {
    if (auto status = need({{channel, "channel"}, {world, "world"}}); !status) return status;
    if (auto status = check_world(*channel, world); !status) return status;
    return channel->channel.begin_step(world->world);
  });
}

souple_status souple_haptic_publish(souple_haptic_channel* channel, const souple_world* world) {
  return guarded([&]() -> Status {
    if (auto status = need({{channel, "channel"}, {world, "world"}}); !status) return status;
    if (auto status = check_world(*channel, world); !status) return status;
    return channel->channel.publish(world->world);
  });
}

souple_status souple_haptic_newest_sample(souple_haptic_channel* channel, souple_device_sample* sample,
                                          int32_t* is_there) {
  return guarded([&]() -> Status {
    if (auto status = need({{channel, "channel"}, {sample, "sample"}, {is_there, "is_there"}}); !status)
      return status;
    DeviceSample newest;
    *is_there = channel->channel.newest_sample(newest);
    if (*is_there) *sample = from_sample(newest);
    return {};
  });
}

souple_status souple_haptic_tick(souple_haptic_channel* channel, const souple_device_sample* sample,
                                 souple_wrench* wrench) {
  return guarded([&]() -> Status {
    if (auto status = need({{channel, "channel"}, {wrench, "wrench"}}); !status) return status;
    *wrench = from_wrench(
        sample ? channel->channel.tick({sample->time_s, to_pose(sample->pose), sample->opening_rad})
               : channel->channel.tick());
    return {};
  });
}

souple_status souple_haptic_last_tick(const souple_haptic_channel* channel, souple_wrench* lawful,
                                      double* residual) {
  return guarded([&]() -> Status {
    if (auto status = need({{channel, "channel"}}); !status) return status;
    if (lawful) *lawful = from_wrench(channel->channel.lawful_wrench());
    if (residual) *residual = channel->channel.residual();
    return {};
  });
}

souple_status souple_haptic_telemetry_init(souple_haptic_telemetry* telemetry, size_t struct_size) {
  return guarded([&] { return init_struct(telemetry, struct_size, {}, "telemetry"); });
}

souple_status souple_haptic_get_telemetry(const souple_haptic_channel* channel,
                                          souple_haptic_telemetry* telemetry) {
  return guarded([&]() -> Status {
    if (auto status = need({{channel, "channel"}, {telemetry, "telemetry"}}); !status) return status;
    return write_struct(telemetry, from_telemetry(channel->channel.telemetry()), "telemetry");
  });
}

double souple_histogram_quantile(const souple_histogram* histogram, double share) {
  if (!histogram) return 0;
  LogHistogram made{histogram->lowest, histogram->ratio, {}};
  std::ranges::copy(histogram->count, made.count.begin());
  return made.quantile(share);
}

}  // extern "C"
