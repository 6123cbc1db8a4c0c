// SPDX-License-Identifier: MIT
// What the C interface refuses of joints, grabs, picks, steps and their results.

#include "c_refusals.hpp"

namespace souple {
namespace {

using namespace test;

TEST_F(CRefusals, JointsGrabsAndPicks) {
  souple_joint joint = 0;
  souple_grab grab = 0;
  souple_pick_hit hit{};
  auto good = initialised(souple_joint_description_init);
  good.body_a = soft;
  const auto with = [&](const char* why, souple_status expected,
                        std::function<void(souple_joint_description&)> spoil) {
    return Refusal{"souple_world_add_joint", why, expected, [=, this] {
                     auto d = good;
                     spoil(d);
                     souple_joint out = 0;
                     return souple_world_add_joint(world, &d, &out);
                   }};
  };
  check({{"souple_world_add_joint", "no world", missing,
          [&] { return souple_world_add_joint(nullptr, &good, &joint); }},
         {"souple_world_add_joint", "no description", missing,
          [&] { return souple_world_add_joint(world, nullptr, &joint); }},
         {"souple_world_add_joint", "no place", missing,
          [&] { return souple_world_add_joint(world, &good, nullptr); }},
         with("size", bad_size, [](auto& d) { d.struct_size = 0; }),
         with("kind", invalid, [](auto& d) { d.kind = 3; }),
         with("reserved", invalid, [](auto& d) { d.reserved = 1; }),
         with("body", SOUPLE_JOINT_INVALID, [](auto& d) { d.body_a = none; }),
         with("other body", SOUPLE_JOINT_INVALID, [](auto& d) { d.body_b = none; }),
         with("itself", SOUPLE_JOINT_INVALID, [](auto& d) { d.body_b = d.body_a; }),
         with("far away", SOUPLE_JOINT_INVALID, [](auto& d) { d.point_m.x = 3; }),
         with("NaN", SOUPLE_JOINT_INVALID, [](auto& d) { d.point_m.x = nan; }),
         with("axis", SOUPLE_JOINT_INVALID,
              [](auto& d) {
                d.axis = {0, 0, 0};
              }),
         with("arm", SOUPLE_JOINT_INVALID, [](auto& d) { d.arm_m = -1; })});
  check({
      {"souple_world_grab", "no world", missing,
       [&] { return souple_world_grab(nullptr, soft, {}, 0, 1, &grab); }},
      {"souple_world_grab", "no place", missing,
       [&] { return souple_world_grab(world, soft, {}, 0, 1, nullptr); }},
      {"souple_world_grab", "body", no_object,
       [&] { return souple_world_grab(world, none, {}, 0, 1, &grab); }},
      {"souple_world_grab", "fixed body", SOUPLE_JOINT_INVALID,
       [&] { return souple_world_grab(world, rigid, {}, 0, 1, &grab); }},
      {"souple_world_grab", "NaN", SOUPLE_JOINT_INVALID,
       [&] {
         return souple_world_grab(world, soft, {nan, 0, 0}, 0, 1, &grab);
       }},
      {"souple_world_grab", "radius", SOUPLE_JOINT_INVALID,
       [&] { return souple_world_grab(world, soft, {}, nan, 1, &grab); }},
      {"souple_world_grab", "nodes", invalid,
       [&] { return souple_world_grab(world, soft, {}, 0, INT32_MAX, &grab); }},
      {"souple_world_move_grab", "no world", missing,
       [&] { return souple_world_move_grab(nullptr, 0, identity); }},
      {"souple_world_move_grab", "no grab", out_of_range,
       [&] { return souple_world_move_grab(world, 3, identity); }},
      {"souple_world_release", "no world", missing, [&] { return souple_world_release(nullptr, 0); }},
      {"souple_world_release", "no grab", out_of_range, [&] { return souple_world_release(world, 0); }},
      {"souple_world_pick", "no world", missing,
       [&] {
         return souple_world_pick(nullptr, {}, {1, 0, 0}, 1, &hit);
       }},
      {"souple_world_pick", "no place", missing,
       [&] {
         return souple_world_pick(world, {}, {1, 0, 0}, 1, nullptr);
       }},
      {"souple_world_pick", "origin", invalid,
       [&] {
         return souple_world_pick(world, {nan, 0, 0}, {1, 0, 0}, 1, &hit);
       }},
      {"souple_world_pick", "direction", invalid,
       [&] {
         return souple_world_pick(world, {}, {0, 0, 0}, 1, &hit);
       }},
      {"souple_world_pick", "NaN direction", invalid,
       [&] {
         return souple_world_pick(world, {}, {0, infinity, 0}, 1, &hit);
       }},
      {"souple_world_pick", "reach", invalid,
       [&] {
         return souple_world_pick(world, {}, {1, 0, 0}, nan, &hit);
       }},
  });
  ASSERT_EQ(souple_world_grab(world, soft, {0, 0, 0.1}, 0, 1, &grab), SOUPLE_OK);
  EXPECT_EQ(souple_world_move_grab(world, grab, nan_pose), out_of_range);
  EXPECT_EQ(souple_world_move_grab(world, grab, not_a_rotation), out_of_range);
  EXPECT_EQ(souple_world_release(world, grab), SOUPLE_OK);
  EXPECT_EQ(souple_world_release(world, grab), out_of_range);
}

TEST_F(CRefusals, StepsAndWhatTheyMade) {
  souple_step_report unsized{};
  souple_pose pose{};
  souple_contact contact{};
  souple_contact_event event{};
  std::vector<Refusal> refusals{
      {"souple_world_step", "no world", missing, [] { return souple_world_step(nullptr, nullptr); }},
      {"souple_world_step", "size", bad_size, [&] { return souple_world_step(world, &unsized); }},
      {"souple_world_run_jobs_with", "no world", missing,
       [] { return souple_world_run_jobs_with(nullptr, nullptr, nullptr); }},
      {"souple_world_rigid_pose", "no world", missing,
       [&] { return souple_world_rigid_pose(nullptr, rigid, &pose); }},
      {"souple_world_rigid_pose", "no place", missing,
       [&] { return souple_world_rigid_pose(world, rigid, nullptr); }},
      {"souple_world_rigid_pose", "soft", no_object,
       [&] { return souple_world_rigid_pose(world, soft, &pose); }},
      {"souple_world_rigid_velocity", "no world", missing,
       [&] { return souple_world_rigid_velocity(nullptr, rigid, nullptr, nullptr); }},
      {"souple_world_rigid_velocity", "body", no_object,
       [&] { return souple_world_rigid_velocity(world, none, nullptr, nullptr); }},
      {"souple_world_contacts", "no world", missing,
       [&] { return souple_world_contacts(nullptr, nullptr, 0, &needed); }},
      {"souple_world_contacts", "small", too_small,
       [&] { return souple_world_contacts(world, &contact, 1, &needed); }},
      {"souple_world_contact_events", "no world", missing,
       [&] { return souple_world_contact_events(nullptr, nullptr, 0, &needed); }},
      {"souple_world_contact_events", "small", too_small,
       [&] { return souple_world_contact_events(world, &event, 0, &needed); }},
  };
  // Functions that read vectors of a soft body.
  const auto reads = [&](const char* function, auto read, auto* buffer) {
    refusals.push_back({function, "no world", missing,
                        [=, this] { return read(nullptr, soft, nullptr, 0, &needed); }});
    refusals.push_back(
        {function, "no body", no_object, [=, this] { return read(world, none, nullptr, 0, &needed); }});
    refusals.push_back(
        {function, "rigid", no_object, [=, this] { return read(world, rigid, nullptr, 0, &needed); }});
    refusals.push_back(
        {function, "nowhere", missing, [=, this] { return read(world, soft, nullptr, 0, nullptr); }});
    refusals.push_back(
        {function, "NULL", missing, [=, this] { return read(world, soft, nullptr, 99, &needed); }});
    refusals.push_back(
        {function, "small", too_small, [=, this] { return read(world, soft, buffer, 1, &needed); }});
  };
  reads("souple_world_positions", souple_world_positions, vectors.data());
  reads("souple_world_velocities", souple_world_velocities, vectors.data());
  reads("souple_world_surface_positions", souple_world_surface_positions, vectors.data());
  reads("souple_world_surface_positions_f32", souple_world_surface_positions_f32, xyz);
  reads("souple_world_visual_positions", souple_world_visual_positions, vectors.data());
  reads("souple_world_visual_positions_f32", souple_world_visual_positions_f32, xyz);
  check(refusals);
}

TEST_F(CRefusals, ABodyThatIsNotShownSaysSo) {
  auto options = initialised(souple_load_options_init);
  options.visual = 0;
  souple_asset* opened = nullptr;
  ASSERT_EQ(souple_asset_open_file(asset_file().c_str(), &options, &opened), SOUPLE_OK);
  const AssetHandle plain(opened);
  const auto body = add_c_soft(world, plain.get(), 1);
  EXPECT_EQ(souple_world_visual_positions(world, body, nullptr, 0, &needed), SOUPLE_ASSET_MISSING_PART);
  EXPECT_EQ(souple_world_visual_positions_f32(world, body, nullptr, 0, &needed),
            SOUPLE_ASSET_MISSING_PART);
}

}  // namespace
}  // namespace souple
