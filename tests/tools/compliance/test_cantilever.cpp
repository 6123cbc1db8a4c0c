// SPDX-License-Identifier: GPL-3.0-or-later
// Reference 3.1: a clamped beam under a tip load, by the factor that the compliance is made with.
#include <gtest/gtest.h>

#include <cmath>

#include "runtime/fem/corotational_model.hpp"
#include "tests/support/box_mesh.hpp"
#include "tools/compliance/supernodal_factor.hpp"

namespace souple {
namespace {

// Mean tip displacement along z of the 1 x 0.1 x 0.1 m beam, E = 210 GPa, nu = 0.3, F = 1000 N.
double tip_displacement(int refinement) {
  const TetMesh mesh =
      test::box_mesh({10 * refinement, refinement, refinement}, {0, 0, 0}, {1, 0.1, 0.1});
  const auto model = CorotationalModel::create(mesh, test::material_of(210e9, 0.3, 7850));
  EXPECT_TRUE(model.ok());
  BlockMatrix stiffness(model->pattern());
  model->assemble_rest(0, 1, stiffness);
  std::vector<Index> free, tip;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n][0] > 1e-9) free.push_back(Index(n));
    if (mesh.nodes[n][0] > 1 - 1e-9) tip.push_back(Index(free.size()) - 1);
  }
  const auto factor = SupernodalFactor::create(stiffness, free);
  EXPECT_TRUE(factor.ok());
  SupernodalFactor::Workspace workspace(*factor, 1);
  std::ranges::fill(workspace.right_sides(), 0.0);
  // The end load as shear spread evenly over the end face's nodes (Saint-Venant: the tip feels F).
  for (const Index node : tip)
    workspace.right_sides()[std::size_t(3 * node + 2)] = 1000.0 / double(tip.size());
  const auto u = factor->solve(workspace, 1);
  double mean = 0;
  for (const Index node : tip) mean += u[std::size_t(3 * node + 2)] / double(tip.size());
  return mean;
}

TEST(Cantilever, RisesMonotonicallyTowardsTimoshenkoUnderNestedRefinement) {
  const double timoshenko = 1.919619e-4;
  const double u1 = tip_displacement(1), u2 = tip_displacement(2), u4 = tip_displacement(4),
               u8 = tip_displacement(8), u16 = tip_displacement(16);
  EXPECT_LT(u1, u2);
  EXPECT_LT(u2, u4);
  EXPECT_LT(u4, u8);
  EXPECT_LT(u8, u16);
  EXPECT_LT(u16, timoshenko);
  EXPECT_GT(u16, 0.97 * timoshenko);
  // Order 2 would quarter the differences; the stress singularities along the edges of the fully
  // clamped face cost some of it, and no more than half an order.
  EXPECT_GT((u8 - u4) / (u16 - u8), std::pow(2.0, 1.5));
  EXPECT_LT((u8 - u4) / (u16 - u8), 4.2);
  const double extrapolated = u16 + (u16 - u8) / 3;
  EXPECT_NEAR(extrapolated, timoshenko, 0.01 * timoshenko);
}

}  // namespace
}  // namespace souple
