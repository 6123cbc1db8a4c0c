// SPDX-License-Identifier: MIT
// Loads on bodies: what they add up to, where they point, when they act, and what is refused.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

// Floats without gravity, alpha = 0, so that the total momentum is the impulse of the loads.
class FloatingBody : public testing::Test {
 protected:
  FloatingBody() : world_(make_world(settings())) {
    body_ = add_soft(world_, asset(), {0, 0, 1}, rotation_);
    mass_ = world_.asset(body_).model().total_mass();
  }
  static WorldSettings settings() {
    WorldSettings s;
    s.gravity_m_s2 = {0, 0, 0};
    s.free_motion.tolerance = 1e-12;
    return s;
  }
  static std::shared_ptr<const SoftBodyAsset> asset() {
    static const auto shared =
        make_body(irregular_box_mesh({3, 3, 3}, {-0.1, -0.1, -0.1}, {0.2, 0.2, 0.2}, 0.5),
                  material_of(1e5, 0.3, 1000, 0, 0.02), 0.01);
    return shared;
  }
  static LoadDescription force(const Vec3& total, std::vector<Index> nodes) {
    LoadDescription load;
    load.name = "push";
    load.nodes = std::move(nodes);
    load.course = {{0, as_point(total), 0}};
    return load;
  }
  Vec3 momentum(int steps) {
    Vec3 last = Vec3::Zero();
    for (int k = 0; k < steps; ++k) last = as_vec3(step(world_).linear_momentum_kg_m_s);
    return last;
  }

  Mat3 rotation_ = turned(50, {1, 2, -1});
  World world_;
  BodyId body_;
  double mass_ = 0;
};

TEST_F(FloatingBody, TakesTheImpulseOfAForceOnNodes) {
  ASSERT_TRUE(world_.add_load(body_, force({1, -2, 3}, {0, 5, 9, 20})).ok());
  const Vec3 expected = 0.2 * Vec3(1, -2, 3);
  EXPECT_LT((momentum(20) - expected).norm(), 1e-9 * expected.norm());
}

TEST_F(FloatingBody, AForceAtASurfacePointTurnsItAboutItsCentre) {
  LoadDescription load;
  load.kind = LoadKind::point_force;
  load.triangle = 4;
  load.weight = {0.2, 0.3, 0.5};
  load.course = {{0, {0, 0, 0.5}, 0}};
  ASSERT_TRUE(world_.add_load(body_, load).ok());
  const Triangle corners = asset()->surface().triangles()[4];
  Vec3 point = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    point += load.weight[k] * as_vec3(world_.positions(body_)[std::size_t(corners[k])]);
  const StepReport report = step(world_);
  EXPECT_LT((as_vec3(report.linear_momentum_kg_m_s) - Vec3(0, 0, 0.005)).norm(), 1e-11);
  // About the origin, at the point where the force acted: torque times time, and what the point moved.
  EXPECT_LT((as_vec3(report.angular_momentum_kg_m2_s) - 0.01 * point.cross(Vec3(0, 0, 0.5))).norm(),
            1e-3 * 0.005);
}

TEST_F(FloatingBody, TractionOfTheWholeBoundaryIsTheAreaTimesIt) {
  LoadDescription load;
  load.kind = LoadKind::traction;
  load.course = {{0, {3, 0, 0}, 0}};
  ASSERT_TRUE(world_.add_load(body_, load).ok());
  const double area = 6 * 0.2 * 0.2;
  EXPECT_LT((momentum(10) - Vec3(0.1 * 3 * area, 0, 0)).norm(), 1e-9);
}

TEST_F(FloatingBody, AVectorThatFollowsIsGivenInTheFrameOfTheBody) {
  LoadDescription load = force({0, 0, 2}, {0, 1, 2, 3});
  load.follows = true;
  ASSERT_TRUE(world_.add_load(body_, load).ok());
  EXPECT_LT((momentum(1) - 0.01 * (rotation_ * Vec3(0, 0, 2))).norm(), 1e-9);
}

TEST_F(FloatingBody, APressureAllAroundPushesNowhereAndShrinksTheVolumeAsTheClosedFormSays) {  // 1.3
  LoadDescription load;
  load.kind = LoadKind::pressure;
  load.follows = true;
  load.course = {{0, {}, 10}};
  ASSERT_TRUE(world_.add_load(body_, load).ok());
  EXPECT_LT(momentum(600).norm(), 1e-9);
  double volume = 0;
  for (const Tet& t : asset()->model().tets()) {
    const auto x = world_.positions(body_);
    volume += signed_volume6(x[std::size_t(t[0])], x[std::size_t(t[1])], x[std::size_t(t[2])],
                             x[std::size_t(t[3])]) /
              6;
  }
  // dV/V = -3 (1 - 2 nu) p / E, and its square.
  const double strain = -3 * (1 - 2 * 0.3) * 10 / 1e5;
  EXPECT_NEAR(volume / 0.008 - 1, strain, 1e-3 * std::abs(strain));
}

TEST_F(FloatingBody, ADeadPressureOnOneSideKeepsItsDirectionAndOneThatFollowsTurnsWithIt) {
  std::vector<Index> top;
  const auto rest = asset()->model().rest_positions();
  const auto triangles = asset()->surface().triangles();
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (std::ranges::all_of(triangles[t], [&](Index n) { return rest[std::size_t(n)][2] > 0.0999; }))
      top.push_back(Index(t));
  LoadDescription load;
  load.kind = LoadKind::pressure;
  load.triangles = top;
  load.course = {{0, {}, 100}};
  const Vec3 into = -100 * 0.04 * (rotation_ * Vec3::UnitZ());
  for (const bool follows : {false, true}) {
    World world = make_world(settings());
    const BodyId body = add_soft(world, asset(), {0, 0, 1}, rotation_);
    load.follows = follows;
    ASSERT_TRUE(world.add_load(body, load).ok());
    EXPECT_LT((as_vec3(step(world).linear_momentum_kg_m_s) - 0.01 * into).norm(), 1e-9);
    // Turned by hand: the dead one does not care.
    const Mat3 turn = turned(90, {1, 0, 0});
    std::vector<Point> x, v(rest.size());
    for (const Point& p : rest) x.push_back(as_point(turn * as_vec3(p)));
    ASSERT_TRUE(world.set_state(body, x, v).ok());
    const Vec3 expected = follows ? Vec3(-100 * 0.04 * (turn * Vec3::UnitZ())) : Vec3(into);
    EXPECT_LT((as_vec3(step(world).linear_momentum_kg_m_s) - 0.01 * expected).norm(), 1e-9);
  }
}

TEST_F(FloatingBody, KeyframesGiveTheImpulseOfTheirCourse) {
  LoadDescription load = force(Vec3::Zero(), {7});
  load.course = {{0.1, {0, 0, 0}, 0}, {0.2, {4, 0, 0}, 0}, {0.3, {0, 0, 0}, 0}};
  ASSERT_TRUE(world_.add_load(body_, load).ok());
  EXPECT_LT(momentum(9).norm(), 1e-12);
  // The value at the end of every step; for a triangle the sum is exact.
  EXPECT_NEAR(momentum(31).x(), 0.5 * 0.2 * 4, 1e-9);
}

TEST_F(FloatingBody, ALoadCanBeReplacedWithoutAllocation) {
  const auto load = world_.add_load(body_, force({1, 0, 0}, {0, 1}));
  ASSERT_TRUE(load.ok());
  (void)momentum(2);
  const std::size_t before = allocation_count();
  const bool set = world_.set_load(*load, {0, {0, 1, 0}, 0}).ok();
  const auto report = world_.step();
  EXPECT_EQ(allocation_count() - before, 0u);
  ASSERT_TRUE(set && report.ok());
  EXPECT_LT((as_vec3(report->linear_momentum_kg_m_s) - Vec3(0.02, 0.01, 0)).norm(), 1e-9);
}

TEST_F(FloatingBody, WorkOfALoadIsTheEnergyItGains) {
  ASSERT_TRUE(world_.add_load(body_, force({0.5, 0, 0}, {0, 1, 2, 3})).ok());
  double work = 0, lost = 0;
  StepReport report;
  for (int k = 0; k < 50; ++k) {
    report = step(world_);
    work += k > 0 ? report.load_work_j : 0;  // the first has nothing to be compared with
    lost += report.lost_energy_j;
    EXPECT_GT(report.lost_energy_j, -1e-12) << k;
  }
  EXPECT_GT(report.kinetic_energy_j + report.elastic_energy_j, 0.5 * work);
  EXPECT_LT(report.kinetic_energy_j + report.elastic_energy_j + lost, 1.1 * work);
}

TEST_F(FloatingBody, RefusesLoadsThatCannotBeAndKeepsTheOnesThereAre) {
  const auto refused = [&](auto spoil) {
    LoadDescription load = force({1, 0, 0}, {0});
    spoil(load);
    const auto added = world_.add_load(body_, load);
    return !added && added.issue().code == IssueCode::load_invalid;
  };
  EXPECT_TRUE(refused([](auto& l) { l.course[0].vector[1] = NAN; }));
  EXPECT_TRUE(refused([](auto& l) { l.course[0].vector[1] = 1e300; }));
  EXPECT_TRUE(refused([](auto& l) { l.course[0].pressure_pa = -INFINITY; }));
  EXPECT_TRUE(refused([](auto& l) { l.course.clear(); }));
  EXPECT_TRUE(refused([](auto& l) { l.course.push_back(l.course[0]); }));
  EXPECT_TRUE(refused([](auto& l) { l.course[0].time_s = NAN; }));
  EXPECT_TRUE(refused([](auto& l) { l.nodes = {}; }));
  EXPECT_TRUE(refused([](auto& l) { l.nodes = {-1}; }));
  EXPECT_TRUE(refused([](auto& l) { l.nodes = {1'000'000}; }));
  EXPECT_TRUE(refused([](auto& l) { l.kind = LoadKind::point_force; }));
  EXPECT_TRUE(refused([](auto& l) {
    l.kind = LoadKind::point_force;
    l.triangle = 0;
    l.weight = {2, -1, 0};
  }));
  EXPECT_TRUE(refused([](auto& l) {
    l.kind = LoadKind::pressure;
    l.triangles = {1'000'000};
  }));
  EXPECT_FALSE(world_.add_load({77}, force({1, 0, 0}, {0})).ok());
  const auto load = world_.add_load(body_, force({1, 0, 0}, {0}));
  ASSERT_TRUE(load.ok());
  EXPECT_FALSE(world_.set_load(*load, {0, {NAN, 0, 0}, 0}).ok());
  EXPECT_FALSE(world_.set_load({0, 9}, {0, {1, 0, 0}, 0}).ok());
  EXPECT_FALSE(world_.set_load({9, 0}, {0, {1, 0, 0}, 0}).ok());
  EXPECT_LT((momentum(1) - Vec3(0.01, 0, 0)).norm(), 1e-9) << "the first value still acts";
}

TEST_F(FloatingBody, AForceTooLargeForTheStepIsRefusedByTheStepAndTheStateKept) {
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
    WorldSettings s = settings();
    s.integrator = integrator;
    s.contact_method = ContactMethod::exact;
    World world = make_world(s);
    const BodyId body = add_soft(world, asset(), {0, 0, 1});
    std::vector<Point> x(world.positions(body).begin(), world.positions(body).end());
    x[3] = {1e300, -1e300, 0};  // its elastic forces overflow
    ASSERT_TRUE(world.set_state(body, x, std::vector<Point>(x.size())).ok());
    const auto report = world.step();
    ASSERT_FALSE(report.ok());
    EXPECT_EQ(report.issue().code, IssueCode::step_not_finite);
    EXPECT_EQ(std::vector<Point>(world.positions(body).begin(), world.positions(body).end()), x);
    const auto rest = asset()->model().rest_positions();
    const std::vector<Point> sound(rest.begin(), rest.end());
    ASSERT_TRUE(world.set_state(body, sound, std::vector<Point>(x.size())).ok());
    EXPECT_LT(step(world).kinetic_energy_j, 1e-12) << "nothing is left of the step that failed";
  }
}

}  // namespace
}  // namespace souple
