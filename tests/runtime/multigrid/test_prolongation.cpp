// SPDX-License-Identifier: MIT
#include "runtime/multigrid/prolongation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <string>

#include "tests/support/level_boxes.hpp"

namespace souple {
namespace {

constexpr Point origin{0.3, -0.2, 0.1}, box{0.2, 0.15, 0.1};

struct TwoLevels {
  MeshLevel coarse, fine;
  Prolongation p;
};

TwoLevels nested() {
  TwoLevels levels{test::level_of(test::box_mesh({3, 2, 2}, origin, box)),
                   test::nested_box({3, 2, 2}, origin, box),
                   {}};
  levels.p = prolongation_of(levels.fine, levels.coarse).value();
  return levels;
}

/// Some fine nodes stand outside of the coarse mesh, which is a smaller box.
TwoLevels embedded() {
  TwoLevels levels;
  levels.coarse =
      test::level_of(test::irregular_box_mesh({3, 2, 2}, {0.305, -0.19, 0.105}, {0.19, 0.13, 0.09}, 1));
  levels.fine =
      test::embedded_level(test::irregular_box_mesh({5, 4, 3}, origin, box, 1), levels.coarse.mesh);
  levels.p = prolongation_of(levels.fine, levels.coarse).value();
  return levels;
}

Eigen::MatrixXd dense(const Prolongation& p) {
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(p.fine_count(), p.coarse_count);
  for (Index i = 0; i < p.fine_count(); ++i)
    for (Index k = p.row_begin[std::size_t(i)]; k < p.row_begin[std::size_t(i) + 1]; ++k)
      m(i, p.column[std::size_t(k)]) += p.weight[std::size_t(k)];
  return m;
}

Eigen::MatrixXd positions(const MeshLevel& level) {
  Eigen::MatrixXd x(level.mesh.nodes.size(), 3);
  for (std::size_t i = 0; i < level.mesh.nodes.size(); ++i)
    x.row(Eigen::Index(i)) = as_vec3(level.mesh.nodes[i]);
  return x;
}

TEST(Prolongation, NestedRowsAreOneOrTwoHalves) {
  const TwoLevels levels = nested();
  for (Index i = 0; i < levels.p.fine_count(); ++i) {
    const auto [a, b] = levels.fine.parents[std::size_t(i)];
    const auto first = std::size_t(levels.p.row_begin[std::size_t(i)]);
    const std::size_t count = std::size_t(levels.p.row_begin[std::size_t(i) + 1]) - first;
    ASSERT_EQ(count, a == b ? 1U : 2U);
    EXPECT_EQ(levels.p.column[first], std::min(a, b));
    EXPECT_EQ(levels.p.column[first + count - 1], std::max(a, b));
    for (std::size_t k = 0; k < count; ++k) EXPECT_EQ(levels.p.weight[first + k], a == b ? 1 : 0.5);
  }
}

TEST(Prolongation, CarriesTranslationsExactlyAndAffineMapsToRounding) {
  for (const TwoLevels& levels : {nested(), embedded()}) {
    const Eigen::MatrixXd p = dense(levels.p);
    EXPECT_LE((p.rowwise().sum().array() - 1).abs().maxCoeff(), 4e-16);
    EXPECT_LE((p * positions(levels.coarse) - positions(levels.fine)).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(Prolongation, PrefersTheEmbeddingToTheParents) {
  TwoLevels levels = nested();
  levels.fine.mesh.nodes[7][0] += 0.004;
  MeshLevel moved = test::embedded_level(levels.fine.mesh, levels.coarse.mesh);
  moved.parents = levels.fine.parents;
  const Prolongation p = prolongation_of(moved, levels.coarse).value();
  EXPECT_LE((dense(p) * positions(levels.coarse) - positions(moved)).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(Prolongation, LeavesOutTheRowsOfFixedNodesOnly) {
  const TwoLevels levels = embedded();
  const Index fixed[] = {0, 17, levels.p.fine_count() - 1};
  const Prolongation moving = without_rows(levels.p, fixed);
  Eigen::MatrixXd expected = dense(levels.p);
  for (const Index node : fixed) expected.row(node).setZero();
  EXPECT_EQ(dense(moving), expected);
  for (const Index node : fixed)
    EXPECT_EQ(moving.row_begin[std::size_t(node)], moving.row_begin[std::size_t(node) + 1]);
}

TEST(Prolongation, ProductsEqualTheDenseOnes) {
  for (const TwoLevels& levels : {nested(), embedded()}) {
    const Prolongation p = without_rows(levels.p, std::array<Index, 2>{3, 11});
    const Eigen::MatrixXf m = dense(p).cast<float>();
    const Eigen::MatrixXf coarse = Eigen::MatrixXf::Random(3, p.coarse_count);
    const Eigen::MatrixXf fine = Eigen::MatrixXf::Random(3, p.fine_count());
    Eigen::VectorXf up(3 * p.fine_count()), down(3 * p.coarse_count);
    prolong(p, coarse.reshaped(), up);
    restrict_to(p, fine.reshaped(), down);
    EXPECT_LE((up.reshaped(3, p.fine_count()) - coarse * m.transpose()).cwiseAbs().maxCoeff(), 1e-6F);
    EXPECT_LE((down.reshaped(3, p.coarse_count) - fine * m).cwiseAbs().maxCoeff(), 1e-5F);
  }
}

TEST(Prolongation, RefusesWhatCannotBeAProlongation) {
  const TwoLevels good = embedded();
  const auto code_after = [&](auto change) {
    MeshLevel fine = good.fine;
    change(fine);
    return prolongation_of(fine, good.coarse).issue().code;
  };
  ASSERT_TRUE(prolongation_of(good.fine, good.coarse).ok());
  EXPECT_EQ(code_after([](MeshLevel& l) { l.embedding.pop_back(); }),
            IssueCode::asset_embedding_invalid);
  EXPECT_EQ(code_after([](MeshLevel& l) { l.embedding.clear(); }), IssueCode::asset_embedding_invalid);
  EXPECT_EQ(code_after([](MeshLevel& l) { l.embedding[5].tet = -1; }),
            IssueCode::asset_index_out_of_range);
  EXPECT_EQ(code_after([](MeshLevel& l) { l.embedding[5].tet = 1 << 30; }),
            IssueCode::asset_index_out_of_range);
  EXPECT_EQ(code_after([](MeshLevel& l) {
              l.embedding[5].weights[2] = std::numeric_limits<double>::quiet_NaN();
            }),
            IssueCode::asset_embedding_invalid);
  EXPECT_EQ(code_after([](MeshLevel& l) { l.embedding[5].weights[2] += 0.1; }),
            IssueCode::asset_embedding_invalid);
  MeshLevel bad = good.fine;
  bad.embedding[5].tet = -7;
  EXPECT_NE(format_issue(prolongation_of(bad, good.coarse).issue()).find("row 5"), std::string::npos);
  const auto wrong_parent = [&](Index parent) {
    MeshLevel fine = nested().fine;
    fine.parents[4][1] = parent;
    return prolongation_of(fine, nested().coarse).issue().code;
  };
  EXPECT_EQ(wrong_parent(-1), IssueCode::asset_index_out_of_range);
  EXPECT_EQ(wrong_parent(100000), IssueCode::asset_index_out_of_range);
}

TEST(Prolongation, MergesWeightsOfOneCoarseNode) {
  MeshLevel coarse = test::level_of(test::box_mesh({1, 1, 1}, origin, box));
  coarse.mesh.tets[0] = {0, 3, 0, 1};
  MeshLevel fine;
  fine.mesh.nodes.resize(1);
  fine.embedding = {{0, {0.25, 0.25, 0.5, 1e-14}}};
  const Prolongation p = prolongation_of(fine, coarse).value();
  EXPECT_EQ(p.column, (std::vector<Index>{0, 3}));
  EXPECT_EQ(p.weight, (std::vector<double>{0.75, 0.25}));
}

}  // namespace
}  // namespace souple
