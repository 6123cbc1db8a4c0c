// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/box_mesh.hpp"
#include "tools/compliance/precompute.hpp"

namespace souple {
namespace {

using namespace test;

const TetMesh cube = box_mesh({2, 2, 2}, {0, 0, 0}, {0.1, 0.1, 0.1});
const Material soft = material_of(1e4, 0.4, 1000);

Issue refusal(const TetMesh& mesh, const Material& material, const FixedSet* fixed,
              const CompliancePrecomputeOptions& options,
              const CompliancePrecomputeSettings& settings = {}) {
  const auto variant =
      precompute_compliance(level_of(mesh), nullptr, material, fixed, options, settings);
  EXPECT_FALSE(variant.ok());
  return variant.ok() ? Issue{} : variant.issue();
}

CompliancePrecomputeOptions static_options() {
  CompliancePrecomputeOptions options;
  options.kind = ComplianceKind::static_equilibrium;
  return options;
}

TEST(ComplianceRefusals, StaticNeedsThreeFixedNodesOffOneLine) {
  EXPECT_EQ(refusal(cube, soft, nullptr, static_options()).code, IssueCode::compliance_singular);
  const FixedSet two{"two", {0, 1}}, line{"line", {0, 1, 2}}, enough{"enough", {0, 1, 3}};
  EXPECT_EQ(refusal(cube, soft, &two, static_options()).code, IssueCode::compliance_singular);
  EXPECT_EQ(refusal(cube, soft, &line, static_options()).code, IssueCode::compliance_singular);
  EXPECT_TRUE(precompute_compliance(level_of(cube), nullptr, soft, &enough, static_options(), {}).ok());
}

TEST(ComplianceRefusals, StaticNeedsSupportOfEveryPartOfTheMesh) {
  TetMesh pair = cube;
  for (const Point& p : cube.nodes) pair.nodes.push_back({p[0] + 1, p[1], p[2]});
  const auto shift = Index(cube.nodes.size());
  for (const Tet& t : cube.tets)
    pair.tets.push_back({t[0] + shift, t[1] + shift, t[2] + shift, t[3] + shift});
  const FixedSet one{"one", {0, 1, 3, 4}}, both{"both", {0, 1, 3, shift, shift + 1, shift + 3}};
  EXPECT_EQ(refusal(pair, soft, &one, static_options()).code, IssueCode::compliance_singular);
  EXPECT_TRUE(precompute_compliance(level_of(pair), nullptr, soft, &both, static_options(), {}).ok());
}

TEST(ComplianceRefusals, FixedSetsMustSelectSomeButNotAll) {
  FixedSet all{"all", {}};
  for (std::size_t n = 0; n < cube.nodes.size(); ++n) all.nodes.push_back(Index(n));
  const FixedSet none{"none", {}}, foreign{"foreign", {0, 1, 999}}, unsorted{"unsorted", {3, 1, 2}};
  for (const FixedSet& set : {none, all, foreign, unsorted}) {
    const Issue issue = refusal(cube, soft, &set, {});
    EXPECT_EQ(issue.code, IssueCode::fixed_set_invalid);
    EXPECT_NE(issue.where.find(set.name), std::string::npos);
  }
}

TEST(ComplianceRefusals, TimeStepsMustBePositiveAndFinite) {
  for (const double h : {0.0, -0.01, double(NAN), double(INFINITY), 1e-9}) {
    CompliancePrecomputeOptions options;
    options.time_step_s = h;
    EXPECT_EQ(refusal(cube, soft, nullptr, options).code, IssueCode::material_out_of_range);
  }
}

TEST(ComplianceRefusals, TooLittleMemoryIsSaidBeforeItIsAllocated) {
  for (const auto way : {ComplianceWay::automatic, ComplianceWay::dense, ComplianceWay::by_solves})
    for (const std::size_t limit : {0U, 1000U, 10000U}) {
      CompliancePrecomputeSettings settings;
      settings.memory_limit_bytes = limit;
      settings.way = way;
      EXPECT_EQ(refusal(cube, soft, nullptr, {}, settings).code, IssueCode::compliance_out_of_memory);
    }
}

TEST(ComplianceRefusals, TolerancesAreZeroOrUpToAHalf) {
  for (const double tolerance : {-1e-3, 0.6, double(NAN), double(INFINITY)}) {
    CompliancePrecomputeOptions options;
    options.tolerance = tolerance;
    EXPECT_EQ(refusal(cube, soft, nullptr, options).code, IssueCode::config_bad_value);
  }
  CompliancePrecomputeOptions dense;
  dense.tolerance = 0;
  CompliancePrecomputeSettings settings;
  settings.way = ComplianceWay::by_solves;
  EXPECT_EQ(refusal(cube, soft, nullptr, dense, settings).code, IssueCode::config_bad_value);
}

TEST(ComplianceRefusals, RegionsMustHoldASurfaceNodeThatMoves) {
  const FixedSet first{"first", {0}};
  const std::vector<std::vector<Index>> regions{{13}, {0}, {5, 4}, {-1, 3}, {3, 999}, {4, 4}};
  for (const auto& nodes : regions) {  // node 13 is inside the cube
    CompliancePrecomputeOptions options;
    options.nodes = nodes;
    EXPECT_EQ(refusal(cube, soft, &first, options).code, IssueCode::compliance_region_empty);
  }
}

TEST(ComplianceRefusals, CoarseningNeedsALevelBelowThatFits) {
  CompliancePrecomputeOptions options;
  options.coarsening = 1;
  EXPECT_EQ(refusal(cube, soft, nullptr, options).code, IssueCode::recipe_needs_coarser_level);
  options.coarsening = 2;
  EXPECT_EQ(refusal(cube, soft, nullptr, options).code, IssueCode::config_bad_value);
  options.coarsening = 1;
  MeshLevel level = level_of(cube);
  const MeshLevel coarser = level_of(box_mesh({1, 1, 1}, {0, 0, 0}, {0.1, 0.1, 0.1}));
  const auto code = [&] {
    const auto variant = precompute_compliance(level, &coarser, soft, nullptr, options, {});
    return variant ? IssueCode{} : variant.issue().code;
  };
  EXPECT_EQ(code(), IssueCode::recipe_needs_coarser_level) << "no embedding, no parents";
  level.parents.assign(cube.nodes.size(), {0, 99});
  EXPECT_EQ(code(), IssueCode::recipe_needs_coarser_level) << "parents outside";
  level.parents.clear();
  level.embedding.assign(cube.nodes.size(), {0, {NAN, 0, 0, 1}});
  EXPECT_EQ(code(), IssueCode::recipe_needs_coarser_level);
}

TEST(ComplianceRefusals, StopsWheneverItIsAsked) {
  for (const auto way : {ComplianceWay::dense, ComplianceWay::by_solves})
    for (const int patience : {0, 1, 5, 20}) {
      CompliancePrecomputeSettings settings;
      settings.way = way;
      settings.threads = 1;
      int asked = 0;
      settings.cancelled = [&] { return asked++ >= patience; };
      const auto variant = precompute_compliance(level_of(cube), nullptr, soft, nullptr, {}, settings);
      if (variant)
        EXPECT_LE(asked, patience) << "it was done before";
      else
        EXPECT_EQ(variant.issue().code, IssueCode::interrupted) << format_issue(variant.issue());
    }
}

TEST(ComplianceRefusals, SliversEitherMeetTheResidualOrAreNamed) {
  for (const double flatness : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15}) {
    TetMesh mesh = cube;
    const Tet first = mesh.tets[0];
    // A fifth tet glued to a face, almost flat.
    const Index top = Index(mesh.nodes.size());
    const auto& p = mesh.nodes;
    Point centre{};
    for (int k = 0; k < 3; ++k)
      for (const Index n : {first[0], first[1], first[2]})
        centre[std::size_t(k)] += p[std::size_t(n)][std::size_t(k)] / 3;
    for (int k = 0; k < 3; ++k)
      centre[std::size_t(k)] +=
          flatness * (centre[std::size_t(k)] - p[std::size_t(first[3])][std::size_t(k)]);
    mesh.nodes.push_back(centre);
    mesh.tets.push_back({first[0], first[2], first[1], top});
    CompliancePrecomputeOptions exact;
    exact.tolerance = 0;
    const auto variant = precompute_compliance(level_of(mesh), nullptr, soft, nullptr, exact, {});
    if (variant) {
      EXPECT_LT(variant->header.error.solve_residual, 1e-6);
      continue;
    }
    const auto code = variant.issue().code;
    EXPECT_TRUE(code == IssueCode::compliance_residual_too_large ||
                code == IssueCode::mesh_element_invalid ||
                code == IssueCode::compliance_factorisation_failed)
        << format_issue(variant.issue());
    EXPECT_NE((variant.issue().what + variant.issue().where).find("tet 48"), std::string::npos);
  }
}

}  // namespace
}  // namespace souple
