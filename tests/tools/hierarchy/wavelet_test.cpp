// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/wavelet.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/tools/hierarchy/hierarchy_shapes.hpp"
#include "tools/hierarchy/refine.hpp"

namespace souple {
namespace {

struct Nested {
  std::size_t coarse_count = 0;
  std::vector<ParentRows> levels;
};

Nested nested_cube(int level_count) {
  TetMesh mesh = kuhn_cube(2);
  Nested nested{mesh.nodes.size(), {}};
  for (int l = 0; l < level_count; ++l) {
    RefinedMesh fine = refine_red(mesh, DiagonalRule::shortest);
    nested.levels.push_back(std::move(fine.parents));
    mesh = std::move(fine.mesh);
  }
  return nested;
}

std::vector<double> prolongated(const Nested& nested, std::vector<double> values,
                                std::size_t components) {
  for (const ParentRows& rows : nested.levels) {
    std::vector<double> fine;
    for (const auto& [a, b] : rows)
      for (std::size_t c = 0; c < components; ++c)
        fine.push_back(0.5 * (values[static_cast<std::size_t>(a) * components + c] +
                              values[static_cast<std::size_t>(b) * components + c]));
    values = std::move(fine);
  }
  return values;
}

TEST(NestedWavelet, ReconstructsDyadicValuesToTheLastBit) {
  const Nested nested = nested_cube(3);
  const auto wavelet = NestedWavelet::make(nested.levels, nested.coarse_count);
  ASSERT_TRUE(wavelet.ok());
  std::mt19937 random(3);
  std::uniform_int_distribution<int> whole(-1000, 1000);
  for (const std::size_t components : {1u, 3u, 7u}) {
    std::vector<double> values(components * wavelet->node_count());
    for (double& v : values) v = whole(random);
    std::vector<double> transformed = values;
    wavelet->forward(transformed, components);
    EXPECT_NE(transformed, values);
    wavelet->inverse(transformed, components);
    EXPECT_EQ(transformed, values);
  }
}

TEST(NestedWavelet, ReconstructsAnyValuesToRounding) {
  const Nested nested = nested_cube(2);
  const auto wavelet = NestedWavelet::make(nested.levels, nested.coarse_count);
  ASSERT_TRUE(wavelet.ok());
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::vector<double> values(3 * wavelet->node_count());
  for (double& v : values) v = normal(random);
  std::vector<double> transformed = values;
  wavelet->forward(transformed, 3);
  wavelet->inverse(transformed, 3);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(transformed[i], values[i], 1e-14);
}

TEST(NestedWavelet, WithoutDetailsIsTheNestedProlongation) {
  const Nested nested = nested_cube(3);
  const auto wavelet = NestedWavelet::make(nested.levels, nested.coarse_count);
  ASSERT_TRUE(wavelet.ok());
  std::vector<double> coarse(3 * nested.coarse_count);
  for (std::size_t i = 0; i < coarse.size(); ++i) coarse[i] = std::sin(double(i));
  std::vector<double> values(3 * wavelet->node_count(), 0.0);
  std::ranges::copy(coarse, values.begin());
  wavelet->inverse(values, 3);
  EXPECT_EQ(values, prolongated(nested, coarse, 3));
}

TEST(NestedWavelet, HasNoDetailsOfAnAffineFieldOnUnmovedNodes) {
  const TetMesh coarse = kuhn_cube(2);
  const RefinedMesh fine = refine_red(coarse, DiagonalRule::best_quality);
  const auto wavelet = NestedWavelet::make({fine.parents}, coarse.nodes.size());
  ASSERT_TRUE(wavelet.ok());
  std::vector<double> values;
  for (const Point& x : fine.mesh.nodes) values.push_back(1 + 2 * x[0] - 3 * x[1] + 5 * x[2]);
  wavelet->forward(values, 1);
  for (std::size_t i = coarse.nodes.size(); i < values.size(); ++i) EXPECT_NEAR(values[i], 0, 1e-14);
}

TEST(NestedWavelet, OfNoLevelsChangesNothing) {
  const auto wavelet = NestedWavelet::make({}, 5);
  ASSERT_TRUE(wavelet.ok());
  EXPECT_EQ(wavelet->node_count(), 5u);
  std::vector<double> values{1, 2, 3, 4, 5};
  wavelet->forward(values, 1);
  EXPECT_EQ(values, (std::vector<double>{1, 2, 3, 4, 5}));
}

TEST(NestedWavelet, RefusesRowsThatAreNotNested) {
  const auto code = [](std::vector<ParentRows> levels, std::size_t coarse) {
    const auto wavelet = NestedWavelet::make(std::move(levels), coarse);
    return wavelet.ok() ? IssueCode{} : wavelet.issue().code;
  };
  EXPECT_EQ(code({{{0, 0}, {1, 1}, {0, 1}}}, 2), IssueCode{});
  const IssueCode invalid = IssueCode::asset_hierarchy_invalid;
  EXPECT_EQ(code({{{0, 0}, {1, 1}, {0, 2}}}, 2), invalid);   // a parent that is not there
  EXPECT_EQ(code({{{0, 0}, {1, 1}, {-1, 1}}}, 2), invalid);  // nor this one
  EXPECT_EQ(code({{{0, 0}, {0, 0}, {0, 1}}}, 2), invalid);   // kept twice
  EXPECT_EQ(code({{{0, 0}, {0, 1}}}, 2), invalid);           // not kept
  EXPECT_EQ(code({{{0, 0}}}, 2), invalid);                   // fewer than before
  EXPECT_EQ(code({{}}, 1u << 31), invalid);
}

}  // namespace
}  // namespace souple
