// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/support/box_mesh.hpp"
#include "tools/compliance/node_ordering.hpp"
#include "tools/compliance/precompute.hpp"

namespace souple {
namespace {

using namespace test;

MeshLevel box_level(const std::array<int, 3>& cells) {
  MeshLevel level;
  level.mesh = irregular_box_mesh(cells, {0, 0, 0}, {0.2, 0.15, 0.1}, 0.4);
  level.boundary = boundary_triangles(level.mesh.tets);
  return level;
}

TEST(NodeOrdering, IsAPermutationAndTheSameEveryTime) {
  const MeshLevel level = box_level({14, 12, 10});
  const auto model = CorotationalModel::create(level.mesh, material_of(1e4, 0.4, 1000));
  ASSERT_TRUE(model.ok()) << format_issue(model.issue());
  std::vector<Index> nodes(level.mesh.nodes.size() - 100);
  std::iota(nodes.begin(), nodes.end(), 50);
  std::vector<Index> surface;
  std::ranges::set_intersection(used_nodes(level.boundary), nodes, std::back_inserter(surface));
  const auto order = order_nodes(model->pattern(), nodes, surface);
  const auto again = order_nodes(model->pattern(), nodes, surface);
  ASSERT_TRUE(order.ok() && again.ok());
  EXPECT_EQ(*order, *again);
  std::vector<Index> sorted = *order;
  std::ranges::sort(sorted);
  ASSERT_EQ(sorted.size(), nodes.size());
  for (std::size_t k = 0; k < sorted.size(); ++k) ASSERT_EQ(sorted[k], Index(k));
}

// Sharing is never seen in the result.
TEST(PreparedBody, GivesEveryVariantTheBytesThatItHasAlone) {
  const MeshLevel level = box_level({8, 6, 5});
  Material material;
  material.regions.push_back({"all", 1e4, 0.4, 1000});
  FixedSet left{"left", {}};
  for (std::size_t k = 0; k < level.mesh.nodes.size(); ++k)
    if (level.mesh.nodes[k][0] < 0.01) left.nodes.push_back(Index(k));
  PreparedBody body(level, material);
  for (const FixedSet* fixed : {static_cast<const FixedSet*>(nullptr), &std::as_const(left)})
    for (const double time_step : {0.01, 0.002}) {
      CompliancePrecomputeOptions options;
      options.time_step_s = time_step;
      const auto shared = precompute_compliance(body, nullptr, fixed, options, {});
      const auto alone = precompute_compliance(level, nullptr, material, fixed, options, {});
      ASSERT_TRUE(shared.ok() && alone.ok());
      EXPECT_EQ(shared->payload, alone->payload);
      EXPECT_EQ(shared->header.error.scaled_spectral, alone->header.error.scaled_spectral);
    }
  const auto model = body.model();
  ASSERT_TRUE(model.ok());
  EXPECT_EQ(*body.model(), *model) << "made once";
}

}  // namespace
}  // namespace souple
