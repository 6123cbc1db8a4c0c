// SPDX-License-Identifier: MIT
// What the equations of motion keep: momentum, energy that does not grow, and that no direction counts.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

std::shared_ptr<const SoftBodyAsset> body_of(double alpha, double beta, int cells = 3) {
  return make_body(
      irregular_box_mesh({cells, cells, cells}, {-0.06, -0.06, -0.06}, {0.12, 0.12, 0.12}, 0.5),
      material_of(1e4, 0.4, 1000, alpha, beta), 0.01);
}

WorldSettings floating(Integrator integrator, double h) {
  WorldSettings settings;
  settings.integrator = integrator;
  settings.time_step_s = h;
  settings.gravity_m_s2 = {0, 0, 0};
  settings.contact_method = ContactMethod::exact;
  settings.free_motion.tolerance = 1e-13;
  return settings;
}

// Stretched by `stretch`, turning at `spin` about its centre, with a velocity of its own at every node.
void excite(World& world, BodyId body, double stretch, const Vec3& spin, double noise) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-noise, noise);
  const auto rest = world.asset(body).model().rest_positions();
  std::vector<Point> x, v;
  for (const Point& p : rest) {
    x.push_back({stretch * p[0], p[1], p[2]});
    const Vec3 own(uniform(random), uniform(random), uniform(random));
    v.push_back(as_point(spin.cross(as_vec3(x.back())) + own + Vec3(0.3, -0.1, 0.2)));
  }
  ASSERT_TRUE(world.set_state(body, x, v).ok());
}

TEST(Conservation, LinearMomentumOfAFreeBodyStaysToRoundOff) {
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
    World world = make_world(floating(integrator, 0.01));
    const BodyId body = add_soft(world, body_of(0, 0.005), Vec3::Zero());
    excite(world, body, 1.2, {3, 1, 2}, 0.2);
    Vec3 before = Vec3::Zero();
    const auto masses = world.asset(body).model().masses();
    for (std::size_t n = 0; n < masses.size(); ++n)
      before += masses[n] * as_vec3(world.velocities(body)[n]);
    Vec3 now = Vec3::Zero();
    for (int k = 0; k < 100; ++k) now = as_vec3(step(world).linear_momentum_kg_m_s);
    EXPECT_LT((now - before).norm(), 1e-11 * before.norm());
  }
}

// Forces are those of rotations that are not exactly the ones at the end of a step, so that the angular
// momentum is kept to the strain times the step, not to round-off.
TEST(Conservation, AngularMomentumOfASpinningBodyDriftsLessWithBdf2) {
  double kept[2];
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
    World world = make_world(floating(integrator, 0.005));
    const BodyId body = add_soft(world, body_of(0, 0.005), Vec3::Zero());
    excite(world, body, 1, {0, 0, 4}, 0);
    const double first = step(world).angular_momentum_kg_m2_s[2];
    double last = 0;
    for (int k = 0; k < 200; ++k) last = step(world).angular_momentum_kg_m2_s[2];
    kept[integrator == Integrator::bdf2] = last / first;
  }
  EXPECT_GT(kept[0], 0.9);
  EXPECT_LT(kept[0], 1.001);
  EXPECT_NEAR(kept[1], 1, 0.01);
}

double energy_of(World& world, BodyId body) {
  const CorotationalModel& model = world.asset(body).model();
  Eigen::VectorXd x(3 * Eigen::Index{model.node_count()});
  double energy = 0;
  for (Index n = 0; n < model.node_count(); ++n) {
    node_entry(x, n) = as_vec3(world.positions(body)[std::size_t(n)]);
    energy += 0.5 * model.masses()[std::size_t(n)] *
              as_vec3(world.velocities(body)[std::size_t(n)]).squaredNorm();
  }
  std::vector<Mat3> rotations;
  model.element_rotations(x, rotations);
  return energy + model.elastic_energy(x, rotations);
}

// Up to four radians a step; beyond, a single linearisation of a step cannot follow, and what it does
// has to die out.
TEST(Conservation, EnergyNeverGrowsUnderImplicitEuler) {
  for (const double h : {1e-5, 1e-3, 1e-2, 1e-1, 1.0})
    for (const double spin : {0.0, 2.0, 10.0, 40.0}) {
      World world = make_world(floating(Integrator::implicit_euler, h));
      const BodyId body = add_soft(world, body_of(0, 0), Vec3::Zero());
      excite(world, body, 1.1, {0, spin, 0.5 * spin}, 0.1);
      const double first = energy_of(world, body);
      double last = first;
      for (int k = 0; k < 60; ++k) {
        const StepReport report = step(world);
        const double energy = report.kinetic_energy_j + report.elastic_energy_j;
        if (h * spin <= 4) {
          EXPECT_LT(energy, last * (1 + 1e-9)) << "h " << h << " spin " << spin << " step " << k;
        }
        last = energy;
      }
      EXPECT_LT(last, first) << "h " << h << " spin " << spin;
    }
}

TEST(Conservation, AThousandRotationsOfAMotionAreThatMotionRotated) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const auto asset = body_of(0.1, 0.01, 2);
  const auto run = [&](const Mat3& turn, Integrator integrator) {
    WorldSettings settings = floating(integrator, 0.01);
    settings.gravity_m_s2 = as_point(turn * Vec3(1, 2, -9.81));
    World world = make_world(settings);
    const BodyId body = add_soft(world, asset, Vec3::Zero());
    const auto rest = asset->model().rest_positions();
    std::vector<Point> x, v;
    for (const Point& p : rest) {
      const Vec3 bent(1.3 * p[0] + 2 * p[1] * p[1], p[1] - 3 * p[0] * p[2], 0.9 * p[2]);
      x.push_back(as_point(turn * bent));
      v.push_back(as_point(turn * Vec3(p[1], 5 * p[2], -2 * p[0])));
    }
    EXPECT_TRUE(world.set_state(body, x, v).ok());
    for (int k = 0; k < 4; ++k) step(world);
    return std::vector<Point>(world.positions(body).begin(), world.positions(body).end());
  };
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
    const auto upright = run(Mat3::Identity(), integrator);
    double worst = 0;
    for (int k = 0; k < 500; ++k) {
      const Mat3 turn =
          Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
              .normalized()
              .toRotationMatrix();
      const auto rotated = run(turn, integrator);
      for (std::size_t n = 0; n < rotated.size(); ++n)
        worst = std::max(worst, (as_vec3(rotated[n]) - turn * as_vec3(upright[n])).norm());
    }
    EXPECT_LT(worst, 1e-8 * 0.12);
  }
}

}  // namespace
}  // namespace souple
