// SPDX-License-Identifier: MIT
// What the C interface refuses of tools and haptic channels.

#include "c_refusals.hpp"

namespace souple {
namespace {

using namespace test;

TEST_F(CRefusals, ToolsAndHapticSettings) {
  const char* function = "souple_haptic_channel_create";
  auto good = initialised(souple_jaw_description_init);
  good.radius_m = 0.01;
  auto unsized = good;
  unsized.struct_size = 16;
  souple_haptic_channel* channel = nullptr;
  const auto with_jaw = [&](const char* why, souple_status expected,
                            std::function<void(souple_jaw_description&)> spoil) {
    return Refusal{function, why, expected, [=, this] {
                     souple_jaw_description jaws[] = {good, good};
                     spoil(jaws[1]);
                     auto tool = initialised(souple_tool_description_init);
                     tool.jaws = jaws, tool.jaw_count = 2;
                     souple_haptic_channel* made = nullptr;
                     return souple_haptic_channel_create(world, &tool, nullptr, &made);
                   }};
  };
  const auto with_tool = [&](const char* why, souple_status expected,
                             std::function<void(souple_tool_description&)> spoil) {
    return Refusal{function, why, expected, [=, this] {
                     auto tool = initialised(souple_tool_description_init);
                     tool.jaws = &good, tool.jaw_count = 1;
                     spoil(tool);
                     souple_haptic_channel* made = nullptr;
                     return souple_haptic_channel_create(world, &tool, nullptr, &made);
                   }};
  };
  const auto with = [&](const char* why, souple_status expected,
                        std::function<void(souple_haptic_settings&)> spoil) {
    return Refusal{function, why, expected, [=, this] {
                     auto tool = initialised(souple_tool_description_init);
                     tool.jaws = &good, tool.jaw_count = 1;
                     auto settings = initialised(souple_haptic_settings_init);
                     spoil(settings);
                     souple_haptic_channel* made = nullptr;
                     return souple_haptic_channel_create(world, &tool, &settings, &made);
                   }};
  };
  auto tool = initialised(souple_tool_description_init);
  tool.jaws = &good, tool.jaw_count = 1;
  check({
      {function, "no world", missing,
       [&] { return souple_haptic_channel_create(nullptr, &tool, nullptr, &channel); }},
      {function, "no tool", missing,
       [&] { return souple_haptic_channel_create(world, nullptr, nullptr, &channel); }},
      {function, "no place", missing,
       [&] { return souple_haptic_channel_create(world, &tool, nullptr, nullptr); }},
      with_tool("size", bad_size, [](auto& t) { t.struct_size = 2; }),
      with_tool("reserved", invalid, [](auto& t) { t.reserved = 2; }),
      with_tool("name", invalid, [](auto& t) { t.name = "\xFE"; }),
      with_tool("no jaws", invalid, [](auto& t) { t.jaw_count = 0; }),
      with_tool("many jaws", invalid, [](auto& t) { t.jaw_count = SIZE_MAX; }),
      with_tool("jaws of NULL", missing, [](auto& t) { t.jaws = nullptr; }),
      with_tool("unsized jaw", bad_size, [&](auto& t) { t.jaws = &unsized; }),
      with_tool("pose", out_of_range, [](auto& t) { t.pose = nan_pose; }),
      with_tool("opening", out_of_range, [](auto& t) { t.opening_rad = nan; }),
      with_jaw("sizes", bad_size, [](auto& j) { j.struct_size += 8; }),
      with_jaw("shape", invalid, [](auto& j) { j.shape = 9; }),
      with_jaw("plane", invalid, [](auto& j) { j.shape = SOUPLE_SHAPE_PLANE; }),
      with_jaw("radius", out_of_range, [](auto& j) { j.radius_m = nan; }),
      with_jaw("no mesh", out_of_range, [](auto& j) { j.shape = SOUPLE_SHAPE_MESH; }),
      with_jaw("hinge", out_of_range, [](auto& j) { j.hinge = nan_pose; }),
      with_jaw("mount", out_of_range, [](auto& j) { j.mount = nan_pose; }),
      with_jaw("axis", out_of_range,
               [](auto& j) {
                 j.axis = {0, 0, 0};
               }),
      with_jaw("turn", out_of_range, [](auto& j) { j.turn_per_opening = nan; }),
      with_jaw("stiffness", out_of_range, [](auto& j) { j.stiffness_n_m = -1; }),
      with_jaw("turn stiffness", out_of_range, [](auto& j) { j.turn_stiffness_nm_rad = nan; }),
      with_jaw("damping", out_of_range, [](auto& j) { j.damping_n_s_m = -1; }),
      with_jaw("turn damping", out_of_range, [](auto& j) { j.turn_damping_nm_s_rad = infinity; }),
      with_jaw("centre", out_of_range, [](auto& j) { j.centre_m.x = nan; }),
      with_jaw("look ahead", out_of_range, [](auto& j) { j.look_ahead_m = nan; }),
      with("size", bad_size, [](auto& s) { s.struct_size = 8; }),
      with("reserved", invalid, [](auto& s) { s.reserved = 8; }),
      with("capacity", out_of_range, [](auto& s) { s.contact_capacity = 0; }),
      with("large capacity", out_of_range, [](auto& s) { s.contact_capacity = SIZE_MAX; }),
      with("budget", out_of_range, [](auto& s) { s.tick_budget_s = nan; }),
      with("residual", out_of_range, [](auto& s) { s.residual_goal = -1; }),
      with("sweeps", out_of_range, [](auto& s) { s.max_sweeps = 0; }),
      with("hand-over", out_of_range, [](auto& s) { s.hand_over_s = nan; }),
      with("hand-over share", out_of_range, [](auto& s) { s.hand_over_share = nan; }),
      with("death", out_of_range, [](auto& s) { s.dead_after_s = 0; }),
      with("fade", out_of_range, [](auto& s) { s.fade_s = nan; }),
      with("speed", out_of_range, [](auto& s) { s.credible_speed_m_s = nan; }),
      with("turn speed", out_of_range, [](auto& s) { s.credible_turn_rad_s = -1; }),
      with("recovery", out_of_range, [](auto& s) { s.recover_after_s = infinity; }),
      with("reach", out_of_range, [](auto& s) { s.reach_m = 0; }),
      with("lead", out_of_range, [](auto& s) { s.lead_s = -0.001; }),
      with("rate", out_of_range, [](auto& s) { s.device_rate_hz = nan; }),
      with("force", out_of_range, [](auto& s) { s.device_force_n = nan; }),
      with("slew", out_of_range, [](auto& s) { s.device_torque_slew_nm_s = -1; }),
  });
  EXPECT_EQ(channel, nullptr);
  souple_haptic_channel_destroy(nullptr);
}

TEST_F(CRefusals, HapticChannels) {
  auto jaw = initialised(souple_jaw_description_init);
  jaw.radius_m = 0.01;
  auto tool = initialised(souple_tool_description_init);
  tool.jaws = &jaw, tool.jaw_count = 1, tool.pose.translation_m = {0, 0, 1};
  souple_haptic_channel* made = nullptr;
  ASSERT_EQ(souple_haptic_channel_create(world, &tool, nullptr, &made), SOUPLE_OK)
      << souple_last_error_what();
  const ChannelHandle handle(made);
  souple_haptic_channel* channel = made;
  const WorldHandle other = make_c_world();
  souple_device_sample sample{0, identity, 0};
  souple_wrench wrench{};
  souple_haptic_telemetry unsized{};
  auto telemetry = initialised(souple_haptic_telemetry_init);
  check({
      {"souple_haptic_tool_bodies", "no channel", missing,
       [&] { return souple_haptic_tool_bodies(nullptr, &body_out, 1, &needed); }},
      {"souple_haptic_tool_bodies", "small", too_small,
       [&] { return souple_haptic_tool_bodies(channel, &body_out, 0, &needed); }},
      {"souple_haptic_begin_step", "no channel", missing,
       [&] { return souple_haptic_begin_step(nullptr, world); }},
      {"souple_haptic_begin_step", "no world", missing,
       [&] { return souple_haptic_begin_step(channel, nullptr); }},
      {"souple_haptic_begin_step", "another world", no_object,
       [&] { return souple_haptic_begin_step(channel, other.get()); }},
      {"souple_haptic_publish", "no channel", missing,
       [&] { return souple_haptic_publish(nullptr, world); }},
      {"souple_haptic_publish", "no world", missing,
       [&] { return souple_haptic_publish(channel, nullptr); }},
      {"souple_haptic_publish", "another world", no_object,
       [&] { return souple_haptic_publish(channel, other.get()); }},
      {"souple_haptic_newest_sample", "no channel", missing,
       [&] { return souple_haptic_newest_sample(nullptr, &sample, &number); }},
      {"souple_haptic_newest_sample", "no sample", missing,
       [&] { return souple_haptic_newest_sample(channel, nullptr, &number); }},
      {"souple_haptic_newest_sample", "no place", missing,
       [&] { return souple_haptic_newest_sample(channel, &sample, nullptr); }},
      {"souple_haptic_tick", "no channel", missing,
       [&] { return souple_haptic_tick(nullptr, &sample, &wrench); }},
      {"souple_haptic_tick", "no place", missing,
       [&] { return souple_haptic_tick(channel, &sample, nullptr); }},
      {"souple_haptic_last_tick", "no channel", missing,
       [&] { return souple_haptic_last_tick(nullptr, &wrench, nullptr); }},
      {"souple_haptic_get_telemetry", "no channel", missing,
       [&] { return souple_haptic_get_telemetry(nullptr, &telemetry); }},
      {"souple_haptic_get_telemetry", "no telemetry", missing,
       [&] { return souple_haptic_get_telemetry(channel, nullptr); }},
      {"souple_haptic_get_telemetry", "size", bad_size,
       [&] { return souple_haptic_get_telemetry(channel, &unsized); }},
  });
  EXPECT_EQ(souple_histogram_quantile(nullptr, 0.5), 0);
  EXPECT_EQ(souple_histogram_quantile(&telemetry.tick_time_s, nan), 0);
}

}  // namespace
}  // namespace souple
