// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>
#include <random>

#include "runtime/fem/corotational_model.hpp"
#include "runtime/fem/sparse_factor.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"

namespace souple {
namespace {

// A box of which the nodes of one side are held, its tangent, and the factor of what is free.
struct HeldBox {
  std::vector<Index> free_nodes;
  SparseFactor factor;
  Eigen::MatrixXd inverse;  ///< dense, of the same matrix
};

HeldBox make_held_box(std::array<int, 3> cells) {
  const TetMesh mesh = test::irregular_box_mesh(cells, {0, 0, 0}, {0.2, 0.1, 0.1}, 0.8);
  const auto model = std::move(*CorotationalModel::create(mesh, test::material_of(1e4, 0.4, 1000)));
  BlockMatrix a(model.pattern());
  model.assemble_rest(1e4, 2, a);
  HeldBox box;
  std::vector<Eigen::Index> unknowns;
  for (Index node = 0; node < model.node_count(); ++node)
    if (mesh.nodes[std::size_t(node)][0] > 0) {
      box.free_nodes.push_back(node);
      for (int c = 0; c < 3; ++c) unknowns.push_back(3 * node + c);
    }
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * model.node_count(), 3 * model.node_count());
  const BlockPattern& pattern = model.pattern();
  for (Index row = 0; row < model.node_count(); ++row)
    for (Index b = pattern.row_begin[std::size_t(row)]; b < pattern.row_begin[std::size_t(row) + 1];
         ++b)
      dense.block<3, 3>(3 * row, 3 * pattern.column[std::size_t(b)]) = a.block(b);
  box.inverse = dense(unknowns, unknowns).inverse();
  box.factor.analyze(model.pattern(), model.rest_positions(), box.free_nodes);
  EXPECT_TRUE(box.factor.factorize(a));
  return box;
}

std::vector<double> inverse_block(const HeldBox& box, std::span<const Index> chosen) {
  std::vector<double> block(9 * chosen.size() * chosen.size(), std::nan(""));
  InverseBlockWork work;
  box.factor.inverse_block(chosen, block, work);
  return block;
}

// Largest error over the largest entry of the inverse.
double error_of(const HeldBox& box, std::span<const Index> chosen, std::span<const double> block) {
  const std::size_t size = 3 * chosen.size();
  double error = 0;
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < size; ++j) {
      const double exact =
          box.inverse(3 * chosen[i / 3] + Eigen::Index(i % 3), 3 * chosen[j / 3] + Eigen::Index(j % 3));
      error = std::max(error, std::abs(block[i * size + j] - exact));
    }
  return error / box.inverse.cwiseAbs().maxCoeff();
}

std::vector<Index> all_nodes(const HeldBox& box) {
  std::vector<Index> chosen(box.free_nodes.size());
  std::iota(chosen.begin(), chosen.end(), Index{0});
  return chosen;
}

TEST(InverseBlock, OfAllNodesIsTheInverse) {
  for (const auto& cells : {std::array{1, 1, 1}, {2, 1, 1}, {4, 3, 3}, {10, 5, 4}}) {
    const HeldBox box = make_held_box(cells);
    const auto chosen = all_nodes(box);
    EXPECT_LT(error_of(box, chosen, inverse_block(box, chosen)), 1e-12) << box.free_nodes.size();
  }
}

TEST(InverseBlock, OfAnySelectionIsTheSameRowsAndColumns) {
  const HeldBox box = make_held_box({10, 5, 4});
  std::mt19937 random(7);
  auto shuffled = all_nodes(box);
  for (const std::size_t count : {1, 2, 3, 4, 5, 7, 8, 13, 35, 100}) {
    std::ranges::shuffle(shuffled, random);
    const std::span<const Index> chosen(shuffled.data(), count);
    EXPECT_LT(error_of(box, chosen, inverse_block(box, chosen)), 1e-12) << count;
    auto sorted = std::vector<Index>(chosen.begin(), chosen.end());  // one region
    std::ranges::sort(sorted);
    std::iota(sorted.begin(), sorted.end(), std::min(sorted[0], Index(200 - count)));
    EXPECT_LT(error_of(box, sorted, inverse_block(box, sorted)), 1e-12) << count;
  }
}

// Separators of more rows than the products take at a time; the factor too is judged by the matrix.
TEST(InverseBlock, OfALargeBodyUndoesTheMatrix) {
  const TetMesh mesh = test::irregular_box_mesh({12, 11, 10}, {0, 0, 0}, {0.2, 0.2, 0.2}, 0.8);
  const auto model = std::move(*CorotationalModel::create(mesh, test::material_of(1e4, 0.4, 1000)));
  BlockMatrix a(model.pattern());
  model.assemble_rest(1e4, 2, a);
  std::vector<Index> nodes(mesh.nodes.size());
  std::iota(nodes.begin(), nodes.end(), Index{0});
  SparseFactor factor;
  factor.analyze(model.pattern(), model.rest_positions(), nodes);
  ASSERT_TRUE(factor.factorize(a));
  const std::size_t size = 3 * nodes.size();
  std::vector<double> block(size * size);
  InverseBlockWork work;
  factor.inverse_block(nodes, block, work);
  const Eigen::Map<const Eigen::MatrixXd> inverse(block.data(), Eigen::Index(size), Eigen::Index(size));
  Eigen::VectorXd product(inverse.rows());
  for (Eigen::Index c = 0; c < inverse.cols(); c += 97) {
    const Eigen::VectorXd column = inverse.col(c);
    multiply(a, column, product);
    product[c] -= 1;
    EXPECT_LT(product.cwiseAbs().maxCoeff(), 1e-11) << c;
  }
}

TEST(InverseBlock, IsTheSameToTheBitAsItsTransposeAndInAnyOrder) {
  const HeldBox box = make_held_box({10, 5, 4});
  std::mt19937 random(8);
  auto shuffled = all_nodes(box);
  std::ranges::shuffle(shuffled, random);
  shuffled.resize(51);
  auto sorted = shuffled;
  std::ranges::sort(sorted);
  const auto first = inverse_block(box, shuffled), second = inverse_block(box, sorted);
  const std::size_t size = 3 * shuffled.size();
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < size; ++j) {
      ASSERT_EQ(first[i * size + j], first[j * size + i]);
      const auto place = [&](std::size_t k) {
        return 3 * std::size_t(std::ranges::find(sorted, shuffled[k / 3]) - sorted.begin()) + k % 3;
      };
      ASSERT_EQ(first[i * size + j], second[place(i) * size + place(j)]);
    }
}

TEST(InverseBlock, RepeatsRowsAndColumnsOfRepeatedNodes) {
  const HeldBox box = make_held_box({4, 3, 3});
  const std::vector<Index> chosen = {17, 3, 17, 40, 3, 17, 9};
  const auto block = inverse_block(box, chosen);
  EXPECT_LT(error_of(box, chosen, block), 1e-12);
  EXPECT_EQ(block[0], block[6]);
  EXPECT_EQ(block[0], block[6 * 3 * chosen.size() + 15]);
}

TEST(InverseBlock, OfNoNodesIsEmpty) {
  const HeldBox box = make_held_box({2, 1, 1});
  EXPECT_TRUE(inverse_block(box, {}).empty());
}

TEST(InverseBlock, AllocatesNothingOnceUsedForAsMany) {
  const HeldBox box = make_held_box({10, 5, 4});
  const auto chosen = all_nodes(box);
  std::vector<double> block(9 * chosen.size() * chosen.size());
  InverseBlockWork work;
  box.factor.inverse_block(chosen, block, work);
  const std::size_t before = test::allocation_count();
  for (const std::size_t count : {chosen.size(), std::size_t{20}, std::size_t{1}, chosen.size()})
    box.factor.inverse_block({chosen.data(), count}, {block.data(), 9 * count * count}, work);
  EXPECT_EQ(test::allocation_count(), before);
}

}  // namespace
}  // namespace souple
