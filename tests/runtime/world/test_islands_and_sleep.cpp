// SPDX-License-Identifier: MIT
// Islands and rest: bodies that do not touch do not know of each other; what rests costs nothing.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/rigid_scenes.hpp"

namespace souple {
namespace {

using namespace test;

std::shared_ptr<const SoftBodyAsset> soft_cube() {
  static const auto asset =
      make_body(irregular_box_mesh({2, 2, 2}, {-0.05, -0.05, -0.05}, {0.1, 0.1, 0.1}, 0.5),
                material_of(5e4, 0.4, 1000, 0.1, 0.01), 0.01);
  return asset;
}

const RigidShape brick = box_shape({0.05, 0.04, 0.03});

// Everything that a step leaves, of all bodies.
std::vector<double> state_of(const World& world) {
  std::vector<double> state;
  const auto take = [&](const Point& p) { state.insert(state.end(), p.begin(), p.end()); };
  for (std::uint32_t k = 0; k < world.body_count(); ++k) {
    if (world.is_soft({k})) {
      for (const Point& p : world.positions({k})) take(p);
      for (const Point& p : world.velocities({k})) take(p);
    } else {
      const Pose pose = world.rigid_pose({k});
      state.insert(state.end(), pose.rotation.begin(), pose.rotation.end());
      take(pose.translation);
      take(world.rigid_velocity({k}));
      take(world.rigid_angular_velocity({k}));
    }
  }
  return state;
}

// A soft cube on a plane, a brick that falls on it, and a hanging pair of rods.
struct Corner {
  BodyId soft, rigid, rod;
};
Corner add_corner(World& world, double x) {
  Corner corner;
  corner.soft = add_soft(world, soft_cube(), {x, 0, 0.06}, turned(15, {1, 1, 0}));
  corner.rigid = add_free(world, brick, {x + 0.01, 0, 0.2}, turned(30, {0, 1, 2}));
  corner.rod = add_free(world, capsule_shape(0.01, 0.05), {x + 0.2, 0, 0.5}, turned(60, {0, 1, 0}));
  JointDescription joint;
  joint.body_a = corner.rod;
  joint.point_m = {x + 0.15, 0, 0.5};
  EXPECT_TRUE(world.add_joint(joint).ok());
  return corner;
}

TEST(Islands, BodiesThatDoNotTouchMoveAsIfAlone) {
  World alone = make_world(WorldSettings{}), both = make_world(WorldSettings{});
  const Corner a = add_corner(alone, 0), b = add_corner(both, 0);
  add_corner(both, 1);
  add_plane(alone);
  add_plane(both);
  std::size_t most = 0;
  for (int k = 0; k < 100; ++k) {
    step(alone);
    most = std::max(most, step(both).island_count);
  }
  EXPECT_GE(most, 4u);
  const auto equal = [](std::span<const Point> x, std::span<const Point> y) {
    return std::ranges::equal(x, y);
  };
  EXPECT_TRUE(equal(alone.positions(a.soft), both.positions(b.soft)));
  EXPECT_TRUE(equal(alone.velocities(a.soft), both.velocities(b.soft)));
  EXPECT_EQ(alone.rigid_pose(a.rigid).translation, both.rigid_pose(b.rigid).translation);
  EXPECT_EQ(alone.rigid_pose(a.rod).rotation, both.rigid_pose(b.rod).rotation);
}

TEST(Islands, GiveTheSameBitsOnFourThreads) {
  const RunJobs threads = [](std::size_t count, const std::function<void(std::size_t)>& job) {
    std::atomic<std::size_t> next{0};
    std::vector<std::thread> all;
    for (int t = 0; t < 4; ++t)
      all.emplace_back([&] {
        for (std::size_t k = next++; k < count; k = next++) job(k);
      });
    for (auto& thread : all) thread.join();
  };
  WorldSettings settings;
  settings.sleep_after_s = 0.3;
  World one = make_world(settings), four = make_world(settings);
  four.run_jobs_with(threads);
  for (World* world : {&one, &four}) {
    for (int k = 0; k < 4; ++k) add_corner(*world, 0.5 * k);
    add_plane(*world);
    for (int k = 0; k < 120; ++k) step(*world);
  }
  EXPECT_EQ(state_of(one), state_of(four));
}

// A heap that is made in another order, or in a world that is turned, where gravity turns with it.
std::vector<Vec3> heap(const Mat3& turn, bool reversed) {
  WorldSettings settings;
  settings.gravity_m_s2 = as_point(turn * Vec3(0, 0, -9.81));
  settings.contact_solver.tolerance = 1e-12;
  World world = make_world(settings);
  std::vector<BodyId> bodies(4);
  if (reversed) add_plane(world, turn);
  for (int n = 0; n < 4; ++n) {
    const int k = reversed ? 3 - n : n;
    const Vec3 at(0.01 * k, -0.008 * k, 0.06 + 0.115 * k);
    const Mat3 rotation = turn * turned(7 * k, {0, 0, 1});
    bodies[std::size_t(k)] = k % 2 == 0 ? add_soft(world, soft_cube(), turn * at, rotation)
                                        : add_free(world, brick, turn * at, rotation);
  }
  if (!reversed) add_plane(world, turn);
  for (int k = 0; k < 40; ++k) step(world);
  std::vector<Vec3> places;
  for (const BodyId body : bodies)
    places.push_back(turn.transpose() *
                     (world.is_soft(body) ? centre_of_mass(world, body) : place_of(world, body)));
  return places;
}

TEST(Islands, OrderOfBodiesAndDirectionOfTheWorldDoNotMatter) {
  const auto places = heap(Mat3::Identity(), false);
  const auto reversed = heap(Mat3::Identity(), true), rotated = heap(turned(50, {1, 2, 3}), false);
  for (std::size_t k = 0; k < places.size(); ++k) {
    EXPECT_LT((places[k] - reversed[k]).norm(), 1e-5) << k;
    EXPECT_LT((places[k] - rotated[k]).norm(), 1e-5) << k;
  }
}

struct Stack {
  explicit Stack(WorldSettings settings = {})
      : world((settings.sleep_after_s = 0.3, make_world(settings))) {
    plane = add_plane(world);
    soft = add_soft(world, soft_cube(), {0, 0, 0.05});
    rigid = add_free(world, box_shape({0.07, 0.06, 0.01}), {0, 0, 0.11});
    top = add_soft(world, soft_cube(), {0, 0, 0.17});
  }
  bool all_asleep() const {
    return world.is_asleep(soft) && world.is_asleep(rigid) && world.is_asleep(top);
  }
  bool any_asleep() const {
    return world.is_asleep(soft) || world.is_asleep(rigid) || world.is_asleep(top);
  }
  /// Steps until it sleeps; the whole stack at once.
  void settle() {
    for (int k = 0; k < 1000 && !any_asleep(); ++k) step(world);
    ASSERT_TRUE(all_asleep());
  }
  World world;
  BodyId plane, soft, rigid, top;
};

TEST(Sleep, AStackFallsAsleepTogetherAndKeepsItsBitsAndForces) {
  Stack stack;
  stack.settle();
  const auto state = state_of(stack.world);
  const Vec3 held = event_force(stack.world, stack.plane, stack.soft);
  const double weight = 9.81 * (2 * stack.world.asset(stack.soft).model().total_mass() + 0.336);
  EXPECT_NEAR(held.z(), weight, 0.02 * weight);
  for (int k = 0; k < 50; ++k) {
    const StepReport report = step(stack.world);
    EXPECT_EQ(report.sleeping_count, 3u);
    EXPECT_EQ(report.free_motion_iterations, 0);
    EXPECT_EQ(report.contact_count, 0u);
  }
  EXPECT_EQ(state_of(stack.world), state);
  EXPECT_EQ(event_force(stack.world, stack.plane, stack.soft), held);
  for (const ContactEvent& event : stack.world.contact_events())
    EXPECT_EQ(event.kind, ContactEventKind::persist);
}

TEST(Sleep, WokenByTouchTheForcesAreThereAtOnce) {
  Stack stack;
  stack.settle();
  const Vec3 before = place_of(stack.world, stack.rigid);
  stack.world.wake(stack.top);
  EXPECT_FALSE(stack.any_asleep()) << "all that touch each other wake together";
  for (int k = 0; k < 20; ++k) step(stack.world);
  EXPECT_LT((place_of(stack.world, stack.rigid) - before).norm(), 1e-4) << "it does not sag";
}

TEST(Sleep, IsEndedByWhateverMayMoveTheBody) {
  const auto wakes = [](const char* what, auto&& act) {
    Stack stack;
    stack.settle();
    act(stack);
    EXPECT_FALSE(stack.any_asleep()) << what;
  };
  wakes("a body that falls on it", [](Stack& s) {
    add_free(s.world, sphere_shape(0.02), {0, 0, 0.4});
    for (int k = 0; k < 40 && s.any_asleep(); ++k) step(s.world);
  });
  wakes("a driven body that comes", [](Stack& s) {
    const double t = s.world.time_s();
    add_driven(s.world, sphere_shape(0.02),
               {{t, pose_of(Mat3::Identity(), {0.3, 0, 0.05})},
                {t + 1, pose_of(Mat3::Identity(), {0, 0, 0.05})}});
    for (int k = 0; k < 100 && s.any_asleep(); ++k) step(s.world);
  });
  wakes("a load", [](Stack& s) {
    LoadDescription load;
    load.nodes = {0};
    load.course = {{0, {0.1, 0, 0}}};
    EXPECT_TRUE(s.world.add_load(s.top, load).ok());
  });
  wakes("a grab", [](Stack& s) { EXPECT_TRUE(s.world.grab({s.top, {0.05, 0.05, 0.22}}).ok()); });
  wakes("a joint", [](Stack& s) {
    JointDescription joint;
    joint.body_a = s.rigid;
    joint.point_m = {0, 0, 0.11};
    EXPECT_TRUE(s.world.add_joint(joint).ok());
  });
  wakes("another rule of its pair", [](Stack& s) {
    EXPECT_TRUE(s.world.set_pair(s.top, s.rigid, {0, true}).ok());
  });
  wakes("a state", [](Stack& s) { set_velocity(s.world, s.top, {0, 0, 0.1}); });
}

TEST(Sleep, SetLoadWakesABody) {
  WorldSettings settings;
  settings.sleep_after_s = 0.2;
  World world = make_world(settings);
  add_plane(world);
  const BodyId body = add_soft(world, soft_cube(), {0, 0, 0.05});
  LoadDescription load;
  load.nodes = {0, 1};
  load.course = {{0, {0, 0, 0}}};
  const auto id = world.add_load(body, load);
  ASSERT_TRUE(id.ok());
  for (int k = 0; k < 500 && !world.is_asleep(body); ++k) step(world);
  ASSERT_TRUE(world.is_asleep(body));
  ASSERT_TRUE(world.set_load(*id, {0, {0, 0, 20}}).ok());
  EXPECT_FALSE(world.is_asleep(body));
  for (int k = 0; k < 30; ++k) step(world);
  EXPECT_GT(mean_velocity(world, body).z(), 0.1);
}

TEST(Sleep, ABodyUnderWhichTheFloorMovesAwayFalls) {
  WorldSettings settings;
  settings.sleep_after_s = 0.2;
  World world = make_world(settings);
  const BodyId body = add_free(world, brick, {0, 0, 0.03});
  RigidShape floor = box_shape({1, 1, 0.1});
  add_driven(
      world, floor,
      {{2, pose_of(Mat3::Identity(), {0, 0, -0.1})}, {3, pose_of(Mat3::Identity(), {0, 0, -1.1})}});
  for (int k = 0; k < 180; ++k) step(world);
  EXPECT_TRUE(world.is_asleep(body));
  for (int k = 0; k < 100; ++k) step(world);
  EXPECT_FALSE(world.is_asleep(body));
  EXPECT_LT(place_of(world, body).z(), -0.5);
}

TEST(Snapshot, OfJointsGrabsSleepersAndRigidBodiesGivesTheSameBits) {
  WorldSettings settings;
  settings.sleep_after_s = 0.2;
  World world = make_world(settings);
  add_plane(world);
  const Corner corner = add_corner(world, 0);
  const BodyId sleeper = add_free(world, brick, {-0.5, 0, 0.03});
  const auto held = world.grab({corner.soft, {0.05, 0.05, 0.1}, 0.03, 4});
  ASSERT_TRUE(held.ok());
  for (int k = 0; k < 60; ++k) step(world);
  ASSERT_TRUE(world.is_asleep(sleeper));
  const auto snapshot = world.snapshot();
  const auto go_on = [&] {
    for (int k = 1; k <= 60; ++k) {
      EXPECT_TRUE(world.move_grab(*held, pose_of(Mat3::Identity(), {0, 0, 0.001 * k})).ok());
      step(world);
    }
    return state_of(world);
  };
  const auto first = go_on();
  ASSERT_TRUE(world.restore(snapshot).ok());
  EXPECT_TRUE(world.is_asleep(sleeper));
  EXPECT_EQ(go_on(), first);
  auto spoilt = snapshot;
  spoilt.resize(spoilt.size() - 9);
  EXPECT_FALSE(world.restore(spoilt).ok());
  EXPECT_EQ(state_of(world), first) << "a refusal changes nothing";
}

TEST(Islands, StepsOfTheContactSpaceAllocateNothingOnceWarm) {
  WorldSettings settings;
  settings.sleep_after_s = 5;
  World world = make_world(settings);
  for (int k = 0; k < 3; ++k) add_corner(world, 0.5 * k);
  add_plane(world);
  for (int k = 0; k < 150; ++k) step(world);
  std::size_t fewest = 1000, total = 0;
  for (int k = 0; k < 50; ++k) {
    const std::size_t before = allocation_count();
    ASSERT_TRUE(world.step().ok());
    fewest = std::min(fewest, allocation_count() - before);
    total += allocation_count() - before;
  }
  EXPECT_EQ(fewest, 0u);
  EXPECT_LT(total, 50u) << "growth by new counts of contacts only";
}

}  // namespace
}  // namespace souple
