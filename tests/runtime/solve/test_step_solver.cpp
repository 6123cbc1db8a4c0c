// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "runtime/fem/corotational_model.hpp"
#include "runtime/solve/block_jacobi.hpp"
#include "runtime/solve/step_solver.hpp"
#include "runtime/solve/symmetric_gauss_seidel.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"

namespace souple {
namespace {

struct System {
  std::unique_ptr<CorotationalModel> model;
  std::unique_ptr<BlockMatrix> a;
  Eigen::MatrixXd dense;
  Eigen::VectorXd b;
};

System make_system(double mass_factor) {
  const TetMesh mesh = test::irregular_box_mesh({4, 3, 3}, {0, 0, 0}, {0.2, 0.15, 0.15}, 1.0);
  System s;
  s.model = std::make_unique<CorotationalModel>(
      std::move(*CorotationalModel::create(mesh, test::material_of(1e4, 0.4, 1000))));
  s.a = std::make_unique<BlockMatrix>(s.model->pattern());
  s.model->assemble_rest(mass_factor, 2, *s.a);
  s.dense = 2 * test::dense_stiffness(mesh, 1e4, 0.4);
  const Eigen::VectorXd masses = test::lumped_masses(mesh, 1000);
  for (Eigen::Index i = 0; i < s.dense.rows(); ++i) s.dense(i, i) += mass_factor * masses[i / 3];
  std::srand(1);
  s.b = Eigen::VectorXd::Random(s.dense.rows());
  return s;
}

template <class Used>
StepSolver solver_of(const System& s, Iteration iteration = Iteration::conjugate_gradient) {
  const Index nodes = s.model->node_count();
  StepSolver solver(iteration, std::make_unique<Used>(nodes), nodes);
  solver.set_system({s.a.get(), {}});
  return solver;
}

double measured(const System& s, const Eigen::VectorXd& x) {
  return (s.b - s.dense * x).norm() / s.b.norm();
}

/// The residual times a number.
class Multiple final : public Preconditioner {
 public:
  explicit Multiple(double factor) : factor_(factor) {}
  bool update(const StepSystem&) override { return true; }
  void apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) override { z = factor_ * r; }
  double work_units() const override { return 0; }
  std::size_t bytes() const override { return 0; }

 private:
  double factor_;
};

TEST(StepSolver, SolvesToTheToleranceThatItReports) {
  const System s = make_system(1e4);
  StepSolver solver = solver_of<SymmetricGaussSeidel>(s);
  for (const double tolerance : {1e-2, 1e-6, 1e-10}) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(s.b.size());
    const auto report = solver.solve(s.b, {tolerance, s.b.norm(), 1000}, x);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(measured(s, x), 1.0001 * tolerance);
    EXPECT_NEAR(measured(s, x), report.relative_residual, 1e-13);
  }
}

TEST(StepSolver, GaussSeidelBeatsJacobiBeatsNothing) {
  const System s = make_system(1e3);
  const SolveLimits limits{1e-8, s.b.norm(), 5000};
  Eigen::VectorXd x = Eigen::VectorXd::Zero(s.b.size()), y = x, z = x;
  const int sweeps = solver_of<SymmetricGaussSeidel>(s).solve(s.b, limits, x).iterations;
  const int jacobi = solver_of<BlockJacobi>(s).solve(s.b, limits, y).iterations;
  StepSolver plain(Iteration::conjugate_gradient, std::make_unique<Multiple>(1.0),
                   s.model->node_count());
  plain.set_system({s.a.get(), {}});
  const int none = plain.solve(s.b, limits, z).iterations;
  EXPECT_LT(1.5 * sweeps, jacobi);
  EXPECT_LT(jacobi, none);
  const Eigen::VectorXd exact = s.dense.ldlt().solve(s.b);
  for (const auto* found : {&x, &y, &z}) EXPECT_LT((*found - exact).norm(), 1e-5 * exact.norm());
}

TEST(StepSolver, SaysSoWhenTheIterationsRunOutAndKeepsTheBest) {
  const System s = make_system(1e2);
  for (const int limit : {1, 3, 8, 20}) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(s.b.size());
    StepSolver solver = solver_of<BlockJacobi>(s);
    const auto report = solver.solve(s.b, {1e-12, s.b.norm(), limit}, x);
    EXPECT_FALSE(report.converged);
    EXPECT_EQ(report.iterations, limit);
    EXPECT_NEAR(measured(s, x), report.relative_residual, 1e-13);
    EXPECT_LE(report.relative_residual, 1) << "worse than where it began";
  }
}

// With unit steps this would diverge at once.
TEST(StepSolver, DescentConvergesWithAnInverseThatOvershoots) {
  const System s = make_system(1e5);
  StepSolver solver(Iteration::descent, std::make_unique<Multiple>(1e6), s.model->node_count());
  solver.set_system({s.a.get(), {}});
  Eigen::VectorXd x = Eigen::VectorXd::Zero(s.b.size());
  const auto report = solver.solve(s.b, {1e-6, s.b.norm(), 100000}, x);
  EXPECT_TRUE(report.converged);
  EXPECT_LE(measured(s, x), 1.0001e-6);
}

TEST(StepSolver, APreconditionerThatIsNotPositiveDefiniteEndsIt) {
  const System s = make_system(1e3);
  for (const double factor : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    StepSolver solver(Iteration::conjugate_gradient, std::make_unique<Multiple>(factor),
                      s.model->node_count());
    solver.set_system({s.a.get(), {}});
    Eigen::VectorXd x = Eigen::VectorXd::Zero(s.b.size());
    const auto report = solver.solve(s.b, {1e-6, s.b.norm(), 1000}, x);
    EXPECT_FALSE(report.converged);
    EXPECT_EQ(report.relative_residual, 1);
    EXPECT_TRUE(x.isZero(0));
  }
}

TEST(StepSolver, ARightSideThatIsNotFiniteIsNotSolved) {
  System s = make_system(1e3);
  s.b[5] = std::numeric_limits<double>::quiet_NaN();
  StepSolver solver = solver_of<SymmetricGaussSeidel>(s);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(s.b.size());
  const auto report = solver.solve(s.b, {1e-6, 1, 1000}, x);
  EXPECT_FALSE(report.converged);
  EXPECT_FALSE(std::isfinite(report.relative_residual));
  EXPECT_EQ(report.iterations, 0);
}

TEST(StepSolver, AnAnswerThatIsThereCostsNothing) {
  const System s = make_system(1e3);
  Eigen::VectorXd x = s.dense.ldlt().solve(s.b);
  const auto report = solver_of<SymmetricGaussSeidel>(s).solve(s.b, {1e-8, s.b.norm(), 1000}, x);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 0);
}

TEST(StepSolver, TakesTheSpareWhileItIsLessWorkAndLooksBack) {
  const System s = make_system(1e2);
  const auto count = s.model->node_count();
  StepSolver solver(Iteration::conjugate_gradient, std::make_unique<Multiple>(1.0), count);
  solver.add_spare(std::make_unique<SymmetricGaussSeidel>(count));
  int with_spare = 0;
  for (int step = 0; step < 60; ++step) {
    solver.set_system({s.a.get(), {}});
    Eigen::VectorXd x = Eigen::VectorXd::Zero(s.b.size());
    EXPECT_TRUE(solver.solve(s.b, {1e-6, s.b.norm(), 5000}, x).converged);
    EXPECT_LE(measured(s, x), 1.0001e-6);
    EXPECT_EQ(solver.uses_spare(), step != 0 && step != 51) << step;
    with_spare += solver.uses_spare();
  }
  EXPECT_EQ(with_spare, 58);
}

TEST(StepSolver, KeepsAFirstChoiceThatIsGood) {
  const System s = make_system(1e6);
  const auto count = s.model->node_count();
  StepSolver solver(Iteration::conjugate_gradient, std::make_unique<SymmetricGaussSeidel>(count),
                    count);
  solver.add_spare(std::make_unique<BlockJacobi>(count));
  for (int step = 0; step < 5; ++step) {
    solver.set_system({s.a.get(), {}});
    Eigen::VectorXd x = Eigen::VectorXd::Zero(s.b.size());
    EXPECT_LE(solver.solve(s.b, {1e-6, s.b.norm(), 5000}, x).iterations, 12);
    EXPECT_FALSE(solver.uses_spare());
  }
}

// Beyond what double can hold: the recurrence would claim any residual.
TEST(StepSolver, DoesNotClaimMoreThanRoundOffAllows) {
  const System s = make_system(1);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(s.b.size());
  const auto report = solver_of<SymmetricGaussSeidel>(s).solve(s.b, {1e-18, s.b.norm(), 100000}, x);
  EXPECT_FALSE(report.converged);
  EXPECT_LT(report.iterations, 3000);
  EXPECT_GT(report.relative_residual, 1e-18);
  EXPECT_LT(report.relative_residual, 1e-9);
}

}  // namespace
}  // namespace souple
