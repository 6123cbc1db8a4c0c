// SPDX-License-Identifier: MIT
// The sweeps run over the contacts that bear forces; the answer is the one of sweeps over all of them.
#include <gtest/gtest.h>

#include <cmath>

#include "runtime/contact/contact.hpp"
#include "runtime/contact/local_law.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/rigid_scenes.hpp"

namespace souple {
namespace {

using namespace test;

using DenseW = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Dense {
  DenseW w;
  Eigen::VectorXd q, force;
  std::vector<LocalLaw> laws;

  explicit Dense(const StepContactProblem& problem)
      : w(Eigen::Map<const DenseW>(problem.delassus.data(), Eigen::Index(problem.free_gap.size()),
                                   Eigen::Index(problem.free_gap.size()))),
        q(Eigen::Map<const Eigen::VectorXd>(problem.free_gap.data(),
                                            Eigen::Index(problem.free_gap.size()))),
        force(Eigen::VectorXd::Zero(q.size())) {
    for (std::size_t i = 0; i < problem.laws.size(); ++i) {
      const auto row = Eigen::Index(3 * i);
      laws.emplace_back(problem.laws[i], w.block<3, 3>(row, row));
    }
  }

  // Gauss-Seidel from nothing, every row in double, until nothing moves.
  void solve() {
    for (int sweep = 0; sweep < 20000; ++sweep) {
      double change = 0;
      for (std::size_t i = 0; i < laws.size(); ++i) {
        const auto row = Eigen::Index(3 * i);
        const Vec3 gap = w.middleRows<3>(row) * force + q.segment<3>(row);
        const Vec3 before = force.segment<3>(row), after = laws[i].next_force(gap, before);
        force.segment<3>(row) = after;
        change = std::max(change, (after - before).norm());
      }
      if (change <= 1e-14 * force.norm()) return;
    }
  }

  // Natural map over the norm of the forces.
  double residual_of(const Eigen::VectorXd& f) const {
    const Eigen::VectorXd gap = w * f + q;
    double sum = 0;
    for (std::size_t i = 0; i < laws.size(); ++i) {
      const auto row = Eigen::Index(3 * i);
      sum += laws[i].natural_map(gap.segment<3>(row), f.segment<3>(row)).squaredNorm();
    }
    return std::sqrt(sum) / f.norm();
  }
};

// A slab that tips over onto a plane, and a heavy ball that rolls on it: within the alarm distance are
// many more points than touch.
struct Tipping {
  World world;
  BodyId slab, ball;
};

Tipping make_tipping() {
  WorldSettings settings;
  settings.time_step_s = 0.01;
  settings.alarm_distance_m = 0.03;
  settings.contact_solver = {.tolerance = 1e-9, .max_sweeps = 5000};
  Tipping scene{make_world(settings), {}, {}};
  const auto slab = make_body(box_mesh({10, 6, 2}, {-0.15, -0.1, 0}, {0.3, 0.2, 0.06}),
                              material_of(5e4, 0.4, 1000, 0.1, 0.01), settings.time_step_s);
  scene.slab = add_soft(scene.world, slab, {0, 0, 0.015}, turned(6, {0, 1, 0}));
  scene.ball =
      add_free(scene.world, sphere_shape(0.04), {0.03, 0.02, 0.13}, Mat3::Identity(), weighing(0.8));
  add_plane(scene.world);
  return scene;
}

TEST(ActiveCore, SolvesTheProblemOfAllContacts) {
  Tipping scene = make_tipping();
  std::size_t most_contacts = 0, fewest_active = 1000, both_bodies = 0;
  for (int k = 0; k < 60; ++k) {
    const StepReport report = step(scene.world);
    const StepContactProblem problem = scene.world.contact_problem();
    if (report.active_count == 0) continue;
    most_contacts = std::max(most_contacts, problem.contacts.size());
    fewest_active = std::min(fewest_active, report.active_count);
    both_bodies += contact_force(scene.world, scene.ball).norm() > 0;
    Dense reference(problem);
    const Eigen::VectorXd force =
        Eigen::Map<const Eigen::VectorXd>(problem.force.data(), reference.q.size());
    EXPECT_LT(reference.residual_of(force), 1e-8) << "step " << k;
    reference.solve();
    ASSERT_LT(reference.residual_of(reference.force), 1e-8) << "step " << k;
    // Forces of many points under a stiff face may share a load in many ways; what they move may not.
    const Eigen::VectorXd moved = reference.w * force, expected = reference.w * reference.force;
    EXPECT_LT((moved - expected).norm(), 1e-5 * expected.norm()) << "step " << k;
  }
  EXPECT_GT(most_contacts, 60u);
  EXPECT_LT(fewest_active, most_contacts / 4) << "most are open: there is a core";
  EXPECT_GT(both_bodies, 20u);
}

}  // namespace
}  // namespace souple
