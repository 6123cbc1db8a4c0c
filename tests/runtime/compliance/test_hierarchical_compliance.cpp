// SPDX-License-Identifier: MIT
// The hierarchical compliance as the runtime sees it: any bytes decode to some matrix, and all ways to
// ask for it must agree. What the bytes mean is tested with the encoder, in tests/tools/compliance.
#include "runtime/compliance/hierarchical_compliance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "tests/support/allocation_count.hpp"
#include "tests/support/random_records.hpp"

namespace souple {
namespace {

using Sample = test::RandomRecords;

Eigen::MatrixXd gather_all(const RestCompliance& compliance) {
  std::vector<Index> rows(std::size_t(compliance.row_count()));
  std::iota(rows.begin(), rows.end(), Index{0});
  const Eigen::Index size = 3 * compliance.row_count();
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> out(size, size);
  compliance.gather(rows, {out.data(), std::size_t(out.size())});
  return out;
}

TEST(HierarchicalCompliance, IsSymmetricToTheBit) {
  const Sample sample(93, 3, 11);
  const auto opened = sample.open();
  ASSERT_TRUE(opened.ok()) << opened.issue().what;
  const Eigen::MatrixXd c = gather_all(**opened);
  EXPECT_TRUE(c.allFinite());
  EXPECT_EQ((c - c.transpose()).cwiseAbs().maxCoeff(), 0);
}

TEST(HierarchicalCompliance, BitsOfABlockDependOnItsNodesAlone) {
  const Sample sample(93, 3, 11);
  const auto opened = sample.open();
  ASSERT_TRUE(opened.ok());
  const Eigen::MatrixXd c = gather_all(**opened);
  const std::vector<Index> rows{40, 3, 92, 16, 15, 0, 3, 71}, columns{5, 92, 61, 3, 40};
  ComplianceWork work;
  constexpr std::size_t stride = 19;
  std::vector<float> out(3 * rows.size() * stride, -7.0F);
  (*opened)->gather_block(rows, columns, out.data(), stride, work);
  for (std::size_t i = 0; i < 3 * rows.size(); ++i)
    for (std::size_t j = 0; j < stride; ++j) {
      const float expected =
          j < 3 * columns.size()
              ? float(c(3 * rows[i / 3] + Index(i % 3), 3 * columns[j / 3] + Index(j % 3)))
              : -7.0F;
      EXPECT_EQ(out[i * stride + j], expected) << i << " " << j;
    }
}

TEST(HierarchicalCompliance, AppliesLikeItsDenseMatrix) {
  for (const int depth : {0, 1, 4}) {
    const Sample sample(61, depth, 9);
    const auto opened = sample.open();
    ASSERT_TRUE(opened.ok());
    const Eigen::MatrixXd c = gather_all(**opened);
    const std::vector<Index> rows{7, 60, 1, 33};
    Eigen::VectorXd load = Eigen::VectorXd::Zero(c.rows());
    std::vector<double> force(12), displacement(std::size_t(c.rows()), 99);
    for (std::size_t k = 0; k < force.size(); ++k)
      load[3 * rows[k / 3] + Index(k % 3)] = force[k] = std::sin(double(k) + 1);
    ComplianceWork work;
    EXPECT_TRUE((*opened)->ready_to_apply(rows));
    (*opened)->apply(rows, force, displacement, work);
    const Eigen::VectorXd expected = c * load;
    const Eigen::Map<const Eigen::VectorXd> found(displacement.data(), c.rows());
    EXPECT_LT((found - expected).norm(), 1e-5 * expected.norm()) << depth;
  }
}

TEST(HierarchicalCompliance, AllocatesNothingOnceWarm) {
  const Sample sample(93, 3, 11);
  const auto opened = sample.open();
  ASSERT_TRUE(opened.ok());
  const std::vector<Index> rows{1, 5, 9, 60, 80};
  std::vector<float> out(9 * rows.size() * rows.size());
  std::vector<double> force(3 * rows.size(), 1), displacement(3 * 93);
  ComplianceWork work;
  const auto evaluate = [&] {
    (void)(*opened)->ready(rows);
    (*opened)->gather_block(rows, rows, out.data(), 3 * rows.size(), work);
    (*opened)->apply(rows, force, displacement, work);
  };
  evaluate();
  const auto before = test::allocation_count();
  evaluate();
  EXPECT_EQ(test::allocation_count(), before);
}

/// Records come one by one.
class LateSource final : public BlockSource {
 public:
  LateSource(std::vector<std::byte> payload, std::vector<std::int64_t> begins)
      : memory_(std::move(payload), std::move(begins)) {}
  bool ready(std::size_t leaf) const override { return there[leaf] && memory_.ready(leaf); }
  std::span<const std::byte> block(std::size_t leaf) const override { return memory_.block(leaf); }
  void request(std::size_t leaf) override { asked[leaf] = true; }
  std::size_t resident_bytes() const override { return 0; }

  std::array<bool, 8> there{}, asked{};

 private:
  MemoryBlockSource memory_;
};

TEST(HierarchicalCompliance, NeedsOnlyTheRecordsOfTheRowsThatAreGathered) {
  const Sample sample(93, 3, 11);
  auto late = std::make_unique<LateSource>(sample.payload, sample.index.record_begin);
  LateSource& source = *late;
  const auto whole = sample.open();
  const auto opened = open_rest_compliance(sample.header, sample.index, std::move(late));
  ASSERT_TRUE(whole.ok() && opened.ok());
  const std::vector<Index> rows{sample.index.order[0], sample.index.order[92], sample.index.order[1]};
  EXPECT_FALSE((*opened)->ready(rows));
  EXPECT_EQ(source.asked, (std::array<bool, 8>{true, false, false, false, false, false, false, true}));
  source.there = source.asked;
  EXPECT_TRUE((*opened)->ready(rows));
  EXPECT_FALSE((*opened)->ready_to_apply(rows));
  ComplianceWork work;
  std::vector<float> some(81), all(81);
  (*opened)->gather_block(rows, rows, some.data(), 9, work);
  (*whole)->gather_block(rows, rows, all.data(), 9, work);
  EXPECT_EQ(some, all);
}

TEST(HierarchicalCompliance, RefusesHostileIndices) {
  const auto code_of = [](auto spoil) {
    Sample sample(93, 3, 11);
    spoil(sample);
    const auto opened = sample.open();
    return opened ? IssueCode{} : opened.issue().code;
  };
  EXPECT_EQ(code_of([](auto&) {}), IssueCode{});
  const auto refused = IssueCode::asset_corrupt;
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(code_of([](auto& s) { s.index.depth = -1; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.depth = 62; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.header.node_count = 92; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.header.node_count = std::int64_t{1} << 40; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.order[4] = 93; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.order[4] = s.index.order[5]; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.scale[4][2] = 0; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.scale[4][3] = nan; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.scale[4][3] = 1e30F; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.leaf_step[7] = 1e20F; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.leaf_step[7] = -1; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.leaf_planes[0] = 0; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.planes[0] = 5; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.rank[0] = -3; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.rank[0] = std::numeric_limits<Index>::max(); }), refused);
  EXPECT_EQ(code_of([](auto& s) { ++s.index.rank[0]; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.singular[0] = 0; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.step[0] = nan; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.step.pop_back(); }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.record_begin[3] = -1; }), refused);
  EXPECT_EQ(
      code_of([](auto& s) { s.index.record_begin.back() = std::numeric_limits<std::int64_t>::max(); }),
      refused);
  EXPECT_EQ(code_of([](auto& s) { s.index.record_begin[1] = s.index.record_begin[8]; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.header.shift = -1; }), refused);
  EXPECT_EQ(code_of([](auto& s) { s.header.shift = nan; }), refused);
  // Integers that do not fit the bytes that the index promises.
  EXPECT_EQ(code_of([](auto& s) { s.index.leaf_planes.assign(8, 1); }), refused);
}

TEST(HierarchicalCompliance, RefusesIndicesThatWouldUnpackFewBytesIntoMuchMemory) {
  Sample sample(93, 3, 11);
  HierarchicalIndex& index = sample.index;
  constexpr Index nodes = 100000, leaves = 512;
  sample.header.node_count = nodes;
  index.depth = 9;
  index.order.resize(nodes);
  std::iota(index.order.begin(), index.order.end(), Index{0});
  index.scale.assign(nodes, {1, 0, 1, 0, 0, 1});
  index.leaf_step.assign(leaves, 1e-5F);
  index.leaf_planes.assign(leaves, 1);
  index.rank.assign(leaves - 1, 0);
  index.step.assign(leaves - 1, 1);
  index.rank[0] = 150000;
  index.singular.assign(150000, 1);
  index.planes.assign(150000, 1);
  index.record_begin.assign(leaves + 1, 0);
  sample.payload.clear();
  EXPECT_NE(fault_of(index, nodes, 0), "");
  EXPECT_FALSE(sample.open().ok());
}

TEST(HierarchicalCompliance, SurvivesAnyBytes) {
  Sample sample(93, 3, 11);
  std::mt19937 random(11);
  for (int trial = 0; trial < 200; ++trial) {
    for (std::byte& byte : sample.payload)
      byte = std::byte(random() % (trial % 2 == 0 ? 256 : 2) * 255);
    const auto opened = sample.open();
    if (!opened) continue;  // integers beyond four bytes
    EXPECT_TRUE(gather_all(**opened).allFinite());
  }
}

}  // namespace
}  // namespace souple
