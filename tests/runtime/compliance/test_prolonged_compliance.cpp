// SPDX-License-Identifier: MIT
#include "runtime/compliance/prolonged_compliance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "tests/support/allocation_count.hpp"
#include "tests/support/fake_compliance.hpp"

namespace souple {
namespace {

using test::FakeCompliance;

constexpr Index coarse_count = 30, fine_count = 70;

std::vector<RowProlongation> random_prolongation() {
  std::mt19937 random(5);
  std::uniform_int_distribution<Index> row(0, coarse_count - 1);
  std::normal_distribution<double> weight;
  std::vector<RowProlongation> prolongation(fine_count);
  for (Index k = 0; k < fine_count; ++k) {
    RowProlongation& p = prolongation[std::size_t(k)];
    const int used = 1 + int(k % 4);  // the rest repeats the first with weight 0
    p.row.fill(row(random));
    for (int q = 0; q < used; ++q) {
      if (q > 0) p.row[std::size_t(q)] = row(random);
      p.weight[std::size_t(q)] = weight(random);
    }
  }
  return prolongation;
}

Eigen::MatrixXd matrix_of(const std::vector<RowProlongation>& prolongation) {
  Eigen::MatrixXd p = Eigen::MatrixXd::Zero(3 * fine_count, 3 * coarse_count);
  for (std::size_t row = 0; row < prolongation.size(); ++row)
    for (std::size_t q = 0; q < 4; ++q)
      p.block<3, 3>(3 * Eigen::Index(row), 3 * prolongation[row].row[q]).diagonal().array() +=
          prolongation[row].weight[q];
  return p;
}

struct Fixture {
  std::vector<RowProlongation> prolongation = random_prolongation();
  Eigen::MatrixXd coarse = test::random_compliance(coarse_count, 3 * coarse_count, 2);
  Eigen::MatrixXd fine = matrix_of(prolongation) * coarse * matrix_of(prolongation).transpose();
  const FakeCompliance* inner = nullptr;
  std::unique_ptr<const RestCompliance> compliance;

  explicit Fixture(Index missing_row = -1) {
    auto owned = std::make_unique<FakeCompliance>(coarse);
    owned->missing_row = missing_row;
    inner = owned.get();
    compliance = std::move(ProlongedCompliance::create(std::move(owned), prolongation, "x")).value();
  }
};

TEST(ProlongedCompliance, GathersBlocksOfTheProlongedMatrix) {
  const Fixture f;
  const std::vector<Index> rows{3, 69, 40, 3}, columns{40, 0, 12, 13, 69};
  const std::size_t stride = 3 * columns.size() + 2;
  std::vector<float> out(3 * rows.size() * stride, 7);
  ComplianceWork work;
  f.compliance->gather_block(rows, columns, out.data(), stride, work);
  const double scale = f.fine.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < 3 * rows.size(); ++i) {
    for (std::size_t j = 0; j < 3 * columns.size(); ++j)
      EXPECT_NEAR(out[i * stride + j],
                  f.fine(Eigen::Index(3 * std::size_t(rows[i / 3]) + i % 3),
                         Eigen::Index(3 * std::size_t(columns[j / 3]) + j % 3)),
                  1e-6 * scale);
    EXPECT_EQ(out[i * stride + 3 * columns.size()], 7) << "nothing past the columns";
  }
}

TEST(ProlongedCompliance, IsSymmetricToTheBitAndIndependentOfWhatElseIsAsked) {
  const Fixture f;
  std::vector<Index> all(fine_count);
  for (Index k = 0; k < fine_count; ++k) all[std::size_t(k)] = k;
  const std::size_t size = 3 * all.size();
  std::vector<float> whole(size * size), part(9);
  ComplianceWork work;
  f.compliance->gather_block(all, all, whole.data(), size, work);
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < i; ++j) ASSERT_EQ(whole[i * size + j], whole[j * size + i]);
  for (const auto& [a, b] : {std::pair<Index, Index>{4, 50}, {50, 4}, {33, 33}}) {
    f.compliance->gather_block(std::span(&a, 1), std::span(&b, 1), part.data(), 3, work);
    for (std::size_t k = 0; k < 9; ++k)
      EXPECT_EQ(part[k], whole[(3 * std::size_t(a) + k / 3) * size + 3 * std::size_t(b) + k % 3]);
  }
}

TEST(ProlongedCompliance, IsPositiveSemiDefinite) {
  const Fixture f;
  std::vector<Index> all(fine_count);
  for (Index k = 0; k < fine_count; ++k) all[std::size_t(k)] = k;
  Eigen::MatrixXd c(3 * fine_count, 3 * fine_count);
  f.compliance->gather(all, {c.data(), std::size_t(c.size())});
  const Eigen::VectorXd eigenvalues = c.selfadjointView<Eigen::Lower>().eigenvalues();
  EXPECT_GT(eigenvalues.minCoeff(), -1e-6 * eigenvalues.maxCoeff()) << "to the rounding of floats";
  EXPECT_LT(eigenvalues[3 * (fine_count - coarse_count) - 1], 1e-6 * eigenvalues.maxCoeff())
      << "of the rank of the coarse one";
}

TEST(ProlongedCompliance, AppliesLikeTheDenseProduct) {
  const Fixture f;
  const std::vector<Index> rows{2, 3, 61};
  std::vector<double> force{1, -2, 3, 0.5, 0, 0, 4, 4, -1}, moved(3 * fine_count);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(3 * fine_count);
  for (std::size_t k = 0; k < force.size(); ++k)
    load[Eigen::Index(3 * std::size_t(rows[k / 3]) + k % 3)] = force[k];
  ComplianceWork work;
  f.compliance->apply(rows, force, moved, work);
  const Eigen::VectorXd expected = f.fine * load;
  EXPECT_LT((Eigen::Map<Eigen::VectorXd>(moved.data(), expected.size()) - expected).norm(),
            1e-13 * expected.norm());
}

TEST(ProlongedCompliance, IsReadyWhenAllCoarseRowsAre) {
  const Index missing = random_prolongation()[7].row[1];
  const Fixture f(missing);
  for (Index row = 0; row < fine_count; ++row) {
    const auto& p = f.prolongation[std::size_t(row)];
    EXPECT_EQ(f.compliance->ready(std::span(&row, 1)),
              std::ranges::find(p.row, missing) == p.row.end());
  }
}

TEST(ProlongedCompliance, AllocatesNothingOnceWarm) {
  const Fixture f;
  const std::vector<Index> rows{1, 5, 9}, columns{1, 20};
  std::vector<float> out(54);
  ComplianceWork work;
  f.compliance->gather_block(rows, columns, out.data(), 6, work);
  const std::size_t before = test::allocation_count();
  f.compliance->gather_block(rows, columns, out.data(), 6, work);
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(ProlongedCompliance, RefusesRowsAndWeightsThatCannotBe) {
  const auto code_of = [](auto spoil) {
    auto prolongation = random_prolongation();
    spoil(prolongation);
    const auto made = ProlongedCompliance::create(
        std::make_unique<FakeCompliance>(test::random_compliance(coarse_count, 5, 3)),
        std::move(prolongation), "compliance/x");
    return made ? IssueCode{} : made.issue().code;
  };
  EXPECT_EQ(code_of([](auto&) {}), IssueCode{});
  EXPECT_EQ(code_of([](auto& p) { p[3].row[1] = coarse_count; }), IssueCode::asset_corrupt);
  EXPECT_EQ(code_of([](auto& p) { p[0].row[0] = -1; }), IssueCode::asset_corrupt);
  EXPECT_EQ(code_of([](auto& p) { p[5].weight[0] = NAN; }), IssueCode::asset_corrupt);
  EXPECT_EQ(code_of([](auto& p) { p[5].weight[3] = -1e9; }), IssueCode::asset_corrupt);
  EXPECT_EQ(code_of([](auto& p) { p.clear(); }), IssueCode::asset_corrupt);
}

}  // namespace
}  // namespace souple
