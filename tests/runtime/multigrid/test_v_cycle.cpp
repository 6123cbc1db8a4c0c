// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <memory>

#include "runtime/multigrid/multigrid_preconditioner.hpp"
#include "runtime/solve/step_solver.hpp"
#include "tests/runtime/multigrid/turned_box.hpp"
#include "tests/support/allocation_count.hpp"

namespace souple {
namespace {

using test::BoxCase;
using test::make_problem;
using Problem = test::BoxProblem;

/// The relative residual that the rounding of x alone may leave, 2^-53 |A| |x|. A stiff body on a soft
/// tie moves far, and its forces are small differences: with a contrast of 1e6 it is more than 1e-8.
double rounding_of(const Eigen::VectorXd& x, const Problem& p) {
  BlockMatrix size = *p.a;
  for (double& value : size.values) value = std::abs(value);
  Eigen::VectorXd product(x.size());
  multiply(size, x.cwiseAbs(), product);
  return std::ldexp(product.norm() / p.b.norm(), -53);
}

std::shared_ptr<const MultigridHierarchy> hierarchy_of(const Problem& p) {
  return std::make_shared<const MultigridHierarchy>(
      MultigridHierarchy::create(p.levels, p.model->pattern(), p.fixed).value());
}

struct Solved {
  SolveReport report;
  Eigen::VectorXd x;
};

Solved solve(const Problem& p, double tolerance) {
  StepSolver solver(Iteration::conjugate_gradient,
                    std::make_unique<MultigridPreconditioner>(hierarchy_of(p)), p.model->node_count());
  solver.set_system({p.a.get(), {}});
  Solved solved{{}, Eigen::VectorXd::Zero(p.b.size())};
  solved.report = solver.solve(p.b, {tolerance, p.b.norm(), 400}, solved.x);
  return solved;
}

/// Iterations to a residual of `tolerance`; -1 if it is not reached.
int iterations(const Problem& p, double tolerance = 1e-8) {
  const SolveReport report = solve(p, tolerance).report;
  return report.converged ? report.iterations : -1;
}

void expect_within(int most, const Problem& p, double tolerance = 1e-8) {
  const int count = iterations(p, tolerance);
  EXPECT_GT(count, 0);
  EXPECT_LE(count, most);
}

/// M of the preconditioner as a matrix, column by column.
Eigen::MatrixXd matrix_of(Preconditioner& preconditioner, Eigen::Index size) {
  Eigen::MatrixXd m(size, size);
  Eigen::VectorXd z(size);
  for (Eigen::Index k = 0; k < size; ++k) {
    preconditioner.apply(Eigen::VectorXd::Unit(size, k), z);
    m.col(k) = z;
  }
  return m;
}

Eigen::MatrixXd dense(const BlockMatrix& a) {
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(3 * a.pattern->node_count(), 3 * a.pattern->node_count());
  for (Index row = 0; row < a.pattern->node_count(); ++row)
    for (Index k = a.pattern->row_begin[std::size_t(row)];
         k < a.pattern->row_begin[std::size_t(row) + 1]; ++k)
      m.block<3, 3>(3 * row, 3 * a.pattern->column[std::size_t(k)]) = a.block(k);
  return m;
}

Eigen::MatrixXd dense(const Prolongation& p) {
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(3 * p.fine_count(), 3 * p.coarse_count);
  for (Index i = 0; i < p.fine_count(); ++i)
    for (Index k = p.row_begin[std::size_t(i)]; k < p.row_begin[std::size_t(i) + 1]; ++k)
      m.block<3, 3>(3 * i, 3 * p.column[std::size_t(k)])
          .diagonal()
          .setConstant(p.weight[std::size_t(k)]);
  return m;
}

/// The two-grid cycle by the book: error propagation (I - (D+L)^-1 A) (I - P Ac^-1 P^T A)
/// (I - (D+U)^-1 A), all in dense double matrices; M = (I - E) A^-1.
Eigen::MatrixXd two_grid_reference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& p) {
  Eigen::MatrixXd upper = a, lower = a;
  for (Eigen::Index row = 0; row < a.rows() / 3; ++row) {
    lower.block(3 * row, 3 * row + 3, 3, a.cols() - 3 * row - 3).setZero();
    upper.block(3 * row, 0, 3, 3 * row).setZero();
  }
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(a.rows(), a.cols());
  Eigen::MatrixXd coarse = p.transpose() * a * p;
  for (Eigen::Index k = 0; k < coarse.rows(); ++k)
    if (coarse(k, k) == 0) coarse(k, k) = 1;
  const Eigen::MatrixXd correction = one - p * coarse.llt().solve(p.transpose() * a);
  const Eigen::MatrixXd error = (one - lower.lu().solve(a)) * correction * (one - upper.lu().solve(a));
  return (one - error) * a.inverse();
}

TEST(VCycle, EqualsTheDenseTwoGridCycle) {
  for (const bool is_clamped : {true, false}) {
    BoxCase setup;
    setup.is_clamped = is_clamped;
    const Problem p = make_problem(setup, 2);
    const auto hierarchy = hierarchy_of(p);
    ASSERT_EQ(hierarchy->level_count(), 2U);
    MultigridPreconditioner cycle(hierarchy, 1);
    ASSERT_TRUE(cycle.update({p.a.get(), {}}));
    const Prolongation moving =
        without_rows(prolongation_of(p.levels[1], p.levels[0]).value(), p.fixed);
    const Eigen::MatrixXd expected = two_grid_reference(dense(*p.a), dense(moving));
    const Eigen::MatrixXd actual = matrix_of(cycle, p.b.size());
    EXPECT_LE((actual - expected).norm(), 2e-5 * expected.norm());
  }
}

TEST(VCycle, IsSymmetricPositiveDefinite) {
  for (const int sweep_count : {1, 2}) {
    const Problem p = make_problem({}, 1);
    const auto hierarchy = hierarchy_of(p);
    ASSERT_GE(hierarchy->level_count(), 2U);
    MultigridPreconditioner cycle(hierarchy, sweep_count);
    ASSERT_TRUE(cycle.update({p.a.get(), {}}));
    const Eigen::MatrixXd m = matrix_of(cycle, p.b.size());
    EXPECT_LE((m - m.transpose()).norm(), 1e-5 * m.norm());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(0.5 * (m + m.transpose()))
                  .eigenvalues()
                  .minCoeff(),
              0);
  }
}

TEST(VCycle, FixedNodesMoveByTheirOwnEquationAlone) {
  const Problem p = make_problem({}, 2);
  MultigridPreconditioner cycle(hierarchy_of(p));
  ASSERT_TRUE(cycle.update({p.a.get(), {}}));
  Eigen::VectorXd z(p.b.size());
  cycle.apply(p.b, z);
  for (const Index node : p.fixed) EXPECT_EQ(node_entry(z, node), Vec3(Vec3::Zero()));
}

/// Without a step length that conjugate gradients or a descent would choose.
TEST(VCycle, ContractsTheErrorByItself) {
  const Problem p = make_problem({}, 2);
  MultigridPreconditioner cycle(hierarchy_of(p));
  ASSERT_TRUE(cycle.update({p.a.get(), {}}));
  Eigen::VectorXd error = Eigen::VectorXd::Random(p.b.size()), residual(error.size()), z(error.size());
  double energy = 0;
  for (int step = 0; step <= 30; ++step) {
    multiply(*p.a, error, residual);
    const double now = error.dot(residual);
    if (step > 0) {
      EXPECT_LE(now, 0.85 * 0.85 * energy) << step;
    }
    energy = now;
    cycle.apply(residual, z);
    error -= z;
  }
}

TEST(VCycle, AnyNumberOfGivenLevelsWillDo) {
  BoxCase setup;
  setup.cells = 8;
  for (const std::size_t level_count : {1U, 2U, 3U})
    expect_within(27, make_problem(setup, level_count));
}

TEST(VCycle, IterationsDoNotGrowWithTheMesh) {
  BoxCase setup;
  setup.cells = 5;
  const int coarse = iterations(make_problem(setup, 1));
  setup.cells = 14;
  const int fine = iterations(make_problem(setup, 1));
  ASSERT_GT(coarse, 0);
  ASSERT_GT(fine, 0);
  EXPECT_LE(fine, coarse + 3);
}

TEST(VCycle, AFreeBodyInMotionTakesFewIterations) {
  BoxCase setup;
  setup.is_clamped = false;
  setup.cells = 8;
  expect_within(27, make_problem(setup, 1));
}

TEST(VCycle, CopesWithStiffnessContrastAndNearIncompressibility) {
  BoxCase contrast;
  contrast.contrast = 1e6;
  contrast.cells = 8;
  const Problem stiff_on_soft = make_problem(contrast, 1);
  expect_within(60, stiff_on_soft, rounding_of(solve(stiff_on_soft, 1e-8).x, stiff_on_soft));
  contrast.contrast = 1e-6;
  expect_within(60, make_problem(contrast, 2));
  BoxCase incompressible;
  incompressible.poisson = 0.49;
  incompressible.cells = 8;
  expect_within(120, make_problem(incompressible, 1));
}

TEST(VCycle, MillimetresAndKilometresTakeTheSameIterations) {
  BoxCase setup;
  const int metres = iterations(make_problem(setup, 1));
  for (const double unit : {1e-3, 1e3, 1e-12, 1e12}) {
    setup.unit = unit;
    EXPECT_EQ(iterations(make_problem(setup, 1)), metres) << unit;
  }
}

TEST(VCycle, TinyAndHugeResidualsAreScaled) {
  const Problem p = make_problem({}, 2);
  MultigridPreconditioner cycle(hierarchy_of(p));
  ASSERT_TRUE(cycle.update({p.a.get(), {}}));
  Eigen::VectorXd expected(p.b.size()), z(p.b.size());
  cycle.apply(p.b, expected);
  for (const double factor : {std::ldexp(1.0, -400), std::ldexp(1.0, 400)}) {
    cycle.apply(factor * p.b, z);
    EXPECT_EQ(z, Eigen::VectorXd(factor * expected));
  }
  cycle.apply(Eigen::VectorXd::Zero(p.b.size()), z);
  EXPECT_EQ(z, Eigen::VectorXd::Zero(p.b.size()));
}

TEST(VCycle, RefusesAMatrixThatIsNotFiniteOrPositive) {
  Problem p = make_problem({}, 2);
  MultigridPreconditioner cycle(hierarchy_of(p));
  const std::vector<double> good = p.a->values;
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e9}) {
    p.a->values = good;
    p.a->block(p.a->pattern->diagonal.back()).setConstant(bad);
    EXPECT_FALSE(cycle.update({p.a.get(), {}})) << bad;
  }
}

TEST(VCycle, UpdateAndApplyAllocateNothingAndRepeatTheirBits) {
  const Problem p = make_problem({}, 2);
  MultigridPreconditioner cycle(hierarchy_of(p), 2);
  Eigen::VectorXd first(p.b.size()), second(p.b.size());
  const StepSystem system{p.a.get(), {}};
  ASSERT_TRUE(cycle.update(system));
  cycle.apply(p.b, first);
  const std::size_t before = test::allocation_count();
  ASSERT_TRUE(cycle.update(system));
  cycle.apply(p.b, second);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(first, second);
}

TEST(MultigridHierarchy, RefusesLevelsOfAnotherBody) {
  const Problem p = make_problem({}, 2);
  const auto made =
      MultigridHierarchy::create(std::span(p.levels).first(1), p.model->pattern(), p.fixed);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.issue().code, IssueCode::asset_embedding_invalid);
}

}  // namespace
}  // namespace souple
