// SPDX-License-Identifier: MIT
// Order, damping and limits of the integrators.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "runtime/world/explicit_limit.hpp"
#include "runtime/world/integrator.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double length = 0.2, young = 1e5, density = 1000;

FixedSet wall_of(const TetMesh& mesh) {
  FixedSet wall{"wall", {}};
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (mesh.nodes[n][0] == 0) wall.nodes.push_back(Index(n));
  return wall;
}

std::shared_ptr<const SoftBodyAsset> bar(double poisson, double alpha, double beta) {
  const TetMesh mesh = box_mesh({8, 2, 2}, {0, 0, 0}, {length, 0.05, 0.05});
  return make_body(mesh, material_of(young, poisson, density, alpha, beta), 0.01, {wall_of(mesh)},
                   "wall");
}

WorldSettings settings_of(Integrator integrator, double h) {
  WorldSettings settings;
  settings.integrator = integrator;
  settings.time_step_s = h;
  settings.gravity_m_s2 = {0, 0, 0};
  settings.contact_method = ContactMethod::exact;  // any step, without a stored compliance
  settings.free_motion.tolerance = 1e-12;
  return settings;
}

// A clamped bar with the velocity field of its first axial mode (amplitude m/s), or of a swing.
struct Swing {
  World world;
  BodyId body;
};
Swing start(std::shared_ptr<const SoftBodyAsset> asset, const WorldSettings& settings,
            const Vec3& tip_velocity) {
  Swing swing{make_world(settings), {}};
  swing.body = add_soft(swing.world, asset, Vec3::Zero(), Mat3::Identity(), Vec3::Zero(), "wall");
  const auto rest = asset->model().rest_positions();
  std::vector<Point> x(rest.begin(), rest.end()), v;
  for (const Point& p : rest)
    v.push_back(as_point(std::sin(M_PI * p[0] / (2 * length)) * tip_velocity));
  EXPECT_TRUE(swing.world.set_state(swing.body, x, v).ok());
  return swing;
}

std::vector<Point> after(Swing swing, int steps) {
  for (int k = 0; k < steps; ++k) step(swing.world);
  const auto x = swing.world.positions(swing.body);
  return {x.begin(), x.end()};
}

double distance(const std::vector<Point>& a, const std::vector<Point>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (as_vec3(a[k]) - as_vec3(b[k])).squaredNorm();
  return std::sqrt(sum / double(a.size()));
}

// Error at `seconds` for 2^first ... 2^last steps against eight times as many as the last.
std::vector<double> errors(Integrator integrator, const Vec3& tip_velocity, double seconds, int first,
                           int last, double beta = 1e-3) {
  const auto asset = bar(0.3, 0.1, beta);
  const auto run = [&](Integrator with, int steps) {
    return after(start(asset, settings_of(with, seconds / steps), tip_velocity), steps);
  };
  const auto reference = run(Integrator::bdf2, 8 << last);
  std::vector<double> list;
  for (int k = first; k <= last; ++k) list.push_back(distance(run(integrator, 1 << k), reference));
  return list;
}

TEST(Integrators, AxialVibrationConvergesInSecondOrderWithBdf2AndInFirstWithEuler) {
  // Period 4 L / c = 0.08 s.
  const auto bdf2 = errors(Integrator::bdf2, {0.02, 0, 0}, 0.1, 5, 8);
  const auto euler = errors(Integrator::implicit_euler, {0.02, 0, 0}, 0.1, 5, 8);
  for (std::size_t k = 1; k < bdf2.size(); ++k) {
    if (k > 1) {
      EXPECT_NEAR(bdf2[k - 1] / bdf2[k], 4, 0.5) << k << ": " << bdf2[k];
    }
    EXPECT_LT(euler[k - 1] / euler[k], 2.3) << k;
    EXPECT_LT(bdf2[k], euler[k] / 4);
  }
}

TEST(Integrators, AWideSwingConvergesInSecondOrderWithBdf2) {
  // The tip goes about as far as the bar is long: the rotations change within a step.
  const auto bdf2 = errors(Integrator::bdf2, {0, 0, 1.5}, 0.2, 5, 8);
  for (std::size_t k = 2; k < bdf2.size(); ++k)
    EXPECT_NEAR(bdf2[k - 1] / bdf2[k], 4, 0.6) << k << ": " << bdf2[k];
}

TEST(Integrators, Bdf2FallsExactly) {  // a parabola is what it integrates without error
  WorldSettings settings = settings_of(Integrator::bdf2, 0.01);
  settings.gravity_m_s2 = {0, 0, -9.81};
  World world = make_world(settings);
  const auto body_asset = make_body(box_mesh({2, 2, 2}, {0, 0, 0}, {0.1, 0.1, 0.1}),
                                    material_of(1e4, 0.4, 1000, 0, 0.01), 0.01);
  const BodyId body = add_soft(world, body_asset, {0, 0, 5}, turned(40, {1, 1, 0}), {0.3, 0, 1});
  const Vec3 from = centre_of_mass(world, body);
  for (int k = 0; k < 50; ++k) step(world);
  const Vec3 expected = from + Vec3(0.15, 0, 0.5 - 9.81 * 0.125);
  EXPECT_LT((centre_of_mass(world, body) - expected).norm(), 1e-9);
  EXPECT_LT((mean_velocity(world, body) - Vec3(0.3, 0, 1 - 9.81 * 0.5)).norm(), 1e-9);
}

TEST(Integrators, Bdf2KeepsAVibrationThatEulerDampsAway) {
  const auto asset = bar(0.3, 0, 0);
  double left[2];
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
    Swing swing = start(asset, settings_of(integrator, 0.004), {0.02, 0, 0});  // 20 steps a period
    double first = 0, energy = 0;
    for (int k = 0; k < 100; ++k) {
      const StepReport report = step(swing.world);
      energy = report.kinetic_energy_j + report.elastic_energy_j;
      if (k == 0) first = energy;
      EXPECT_LT(energy, first * (1 + 1e-9));
    }
    left[integrator == Integrator::bdf2] = energy / first;
  }
  EXPECT_LT(left[0], 1e-3);
  EXPECT_GT(left[1], 0.4);
}

TEST(Integrators, QuasiStaticIsWhereADampedSwingComesToRest) {
  WorldSettings still = settings_of(Integrator::quasi_static, 0.01);
  still.gravity_m_s2 = {0, 0, -9.81};
  Swing body = start(bar(0.3, 5, 0.05), still, Vec3::Zero());
  double last_kinetic = 0;
  for (int k = 0; k < 40; ++k) last_kinetic = step(body.world).kinetic_energy_j;
  EXPECT_LT(last_kinetic, 1e-16) << "it has found its place";
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
    WorldSettings moving = settings_of(integrator, 0.01);
    moving.gravity_m_s2 = {0, 0, -9.81};
    const auto end = after(start(bar(0.3, 5, 0.05), moving, Vec3::Zero()), 600);
    const auto x = body.world.positions(body.body);
    const auto rest = body.world.asset(body.body).model().rest_positions();
    EXPECT_GT(distance(end, {rest.begin(), rest.end()}), 0.005);
    EXPECT_LT(distance(end, {x.begin(), x.end()}), 1e-7);
  }
}

TEST(Integrators, QuasiStaticRefusesABodyThatNothingHolds) {
  World world = make_world(settings_of(Integrator::quasi_static, 0.01));
  const TetMesh mesh = box_mesh({3, 1, 1}, {0, 0, 0}, {0.3, 0.1, 0.1});
  FixedSet line{"line", {}};
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (mesh.nodes[n][1] == 0 && mesh.nodes[n][2] == 0) line.nodes.push_back(Index(n));
  const auto asset = make_body(mesh, material_of(1e4, 0.3, 1000), 0.01, {line}, "line");
  for (const char* set : {"", "line"}) {
    SoftBodyDescription description;
    description.fixed_set = set;
    const auto body = world.add_soft_body(asset, description);
    ASSERT_FALSE(body.ok()) << set;
    EXPECT_EQ(body.issue().code, IssueCode::static_body_not_held);
  }
}

TEST(Integrators, ExplicitLimitIsThatOfTheHighestFrequency) {
  const TetMesh mesh = irregular_box_mesh({4, 2, 2}, {0, 0, 0}, {0.2, 0.1, 0.1}, 0.5);
  Eigen::MatrixXd k = dense_stiffness(mesh, 1e4, 0.3);
  const Eigen::VectorXd masses = lumped_masses(mesh, 1000);
  for (Eigen::Index i = 0; i < k.rows(); ++i)
    for (Eigen::Index j = 0; j < k.cols(); ++j) k(i, j) /= std::sqrt(masses[i / 3] * masses[j / 3]);
  const double w2 = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k).eigenvalues().maxCoeff();
  for (const double beta : {0.0, 0.01}) {
    const auto model = CorotationalModel::create(mesh, material_of(1e4, 0.3, 1000, 0.1, beta));
    const double h = explicit_step_limit(*model);
    const double at_limit = h * h * w2 + 2 * h * (0.1 + beta * w2);
    EXPECT_LT(at_limit, 4);
    EXPECT_GT(at_limit, 4 * 0.96);
  }
}

TEST(Integrators, ExplicitEulerIsStableBelowItsLimitAndRefusedAboveIt) {
  const auto asset = bar(0.3, 0.1, 1e-4);
  const double limit = explicit_step_limit(asset->model());
  Swing swing = start(asset, settings_of(Integrator::explicit_euler, 0.98 * limit), {0.02, 0, 0.01});
  double first = 0, energy = 0;
  for (int k = 0; k < 2000; ++k) {
    const StepReport report = step(swing.world);
    energy = report.kinetic_energy_j + report.elastic_energy_j;
    if (k == 0) first = energy;
  }
  EXPECT_LT(energy, 1.5 * first);
  World world = make_world(settings_of(Integrator::explicit_euler, 1.02 * limit));
  const auto body = world.add_soft_body(asset, {});
  ASSERT_FALSE(body.ok());
  EXPECT_EQ(body.issue().code, IssueCode::explicit_step_too_long);
  WorldSettings warped = settings_of(Integrator::explicit_euler, 1e-5);
  warped.contact_method = ContactMethod::warped;
  EXPECT_FALSE(World::create(warped).ok());
}

TEST(Integrators, Bdf2UsesTheComplianceOfTwoThirdsOfAnEulerStep) {
  const auto f = system_factors(Integrator::bdf2, 0.015, 0.1, 0.01);
  EXPECT_NEAR(f.mass, 9 / (4 * 0.015 * 0.015) + 1.5 * 0.1 / 0.015, 1e-9);
  EXPECT_NEAR(f.stiffness, 1 + 1.5 * 0.01 / 0.015, 1e-14);
  const auto asset = make_body(box_mesh({2, 2, 2}, {0, 0, 0}, {0.1, 0.1, 0.1}),
                               material_of(1e4, 0.4, 1000, 0.1, 0.01), 0.01);
  WorldSettings settings;
  settings.integrator = Integrator::bdf2;
  settings.time_step_s = 0.015;
  World world = make_world(settings);
  EXPECT_TRUE(world.add_soft_body(asset, {}).ok());
  settings.time_step_s = 0.01;
  World other = make_world(settings);
  const auto refused = other.add_soft_body(asset, {});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.issue().code, IssueCode::scene_no_matching_compliance);
}

// A block falls on a plane and has to come to rest, whatever the integrator.
TEST(Integrators, ContactWithBdf2ObeysTheLawsAndDoesNotThrowTheBodyBack) {
  const double h = 0.015, fall = 0.2;
  const auto asset = make_body(irregular_box_mesh({3, 3, 3}, {-0.1, -0.1, 0}, {0.2, 0.2, 0.2}, 0.5),
                               material_of(1e4, 0.4, 1000, 0.1, 0.01), 0.01);
  const double weight = asset->model().total_mass() * 9.81;
  for (const ContactMethod method : {ContactMethod::warped, ContactMethod::exact}) {
    WorldSettings settings;
    settings.integrator = Integrator::bdf2;
    settings.time_step_s = h;
    settings.contact_method = method;
    World world = make_world(settings);
    const BodyId body = add_soft(world, asset, {0, 0, fall}, turned(10, {1, 1, 0}));
    add_plane(world);
    StepReport report;
    double highest_after = 0, last_energy = INFINITY;
    bool touched = false;
    for (int k = 0; k < 900; ++k) {
      report = step(world);
      EXPECT_LT(report.cone_violation, 1e-12);
      EXPECT_LT(report.worst_penetration_m, 1e-6) << k;
      touched |= report.active_count > 0;
      const double energy =
          report.kinetic_energy_j + report.elastic_energy_j + report.potential_energy_j;
      EXPECT_LT(energy, last_energy + 0.02 * weight * fall) << k;
      last_energy = energy;
      if (touched) highest_after = std::max(highest_after, centre_of_mass(world, body).z() - 0.1);
    }
    EXPECT_LT(highest_after, 0.6 * fall);
    EXPECT_LT(report.kinetic_energy_j, 1e-8 * weight * 0.2);
    EXPECT_LT((contact_force(world, body) - Vec3(0, 0, weight)).norm(), 1e-4 * weight);
  }
}

TEST(Integrators, AnInelasticStopLeavesNoSpuriousVelocityWithBdf2) {
  // A stiff block dropped flat: all of it stops in one step.
  const auto asset = make_body(box_mesh({1, 1, 1}, {-0.05, -0.05, 0}, {0.1, 0.1, 0.1}),
                               material_of(1e7, 0.0, 1000, 0, 0.05), 0.002 / 1.5);
  WorldSettings settings;
  settings.integrator = Integrator::bdf2;
  settings.time_step_s = 0.002;
  settings.friction = 0;
  World world = make_world(settings);
  const BodyId body = add_soft(world, asset, {0, 0, 0.01}, Mat3::Identity(), {0, 0, -1});
  add_plane(world);
  for (int k = 0; k < 12; ++k) step(world);
  EXPECT_LT(std::abs(mean_velocity(world, body).z()), 0.05);
  EXPECT_LT(centre_of_mass(world, body).z() - 0.05, 1e-3);
}

TEST(Integrators, QuasiStaticContactCarriesTheWeightOfWhatTheWallDoesNot) {
  const TetMesh mesh = box_mesh({8, 2, 2}, {0, 0, 0}, {length, 0.05, 0.05});
  // An endless step: no inertia in the compliance, which makes it the static one.
  const auto asset = make_body(mesh, material_of(2e5, 0.3, 1000), INFINITY, {wall_of(mesh)}, "wall");
  std::vector<Point> end[2];
  for (const ContactMethod method : {ContactMethod::warped, ContactMethod::exact}) {
    WorldSettings settings = settings_of(Integrator::quasi_static, 0.01);
    settings.gravity_m_s2 = {0, 0, -9.81};
    settings.contact_method = method;
    settings.friction = 0;  // with it the end depends on the way there
    World world = make_world(settings);
    const BodyId body = add_soft(world, asset, {0, 0, 0.02}, Mat3::Identity(), Vec3::Zero(), "wall");
    add_plane(world);
    StepReport report;
    for (int k = 0; k < 120; ++k) report = step(world);
    EXPECT_GT(report.active_count, 0u);
    EXPECT_LT(report.worst_penetration_m, 1e-9);
    EXPECT_GT(contact_force(world, body).z(), 0.01);
    end[method == ContactMethod::exact].assign(world.positions(body).begin(),
                                               world.positions(body).end());
  }
  EXPECT_LT(distance(end[0], end[1]), 1e-5 * length);
}

TEST(Integrators, StepsAllocateNothingAndACopyGoesOnWithTheSameBits) {
  for (const Integrator integrator :
       {Integrator::bdf2, Integrator::quasi_static, Integrator::implicit_euler}) {
    Swing swing = start(bar(0.3, 0.1, 0.01), settings_of(integrator, 0.01), {0, 0, 0.5});
    for (int k = 0; k < 5; ++k) step(swing.world);
    Swing copy = start(bar(0.3, 0.1, 0.01), settings_of(integrator, 0.01), {0, 0, 0.5});
    ASSERT_TRUE(copy.world.copy_state(swing.world).ok());
    const std::size_t before = allocation_count();
    for (int k = 0; k < 5; ++k) ASSERT_TRUE(swing.world.step().ok());
    EXPECT_EQ(allocation_count() - before, 0u);
    for (int k = 0; k < 5; ++k) step(copy.world);
    const auto a = swing.world.positions(swing.body), b = copy.world.positions(copy.body);
    EXPECT_TRUE(std::ranges::equal(a, b));
  }
}

}  // namespace
}  // namespace souple
