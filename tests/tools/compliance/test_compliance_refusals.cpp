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
              const CompliancePrecomputeOptions& options) {
  const auto variant = precompute_compliance(level_of(mesh), material, fixed, options);
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
  EXPECT_TRUE(precompute_compliance(level_of(cube), soft, &enough, static_options()).ok());
}

TEST(ComplianceRefusals, StaticNeedsSupportOfEveryPartOfTheMesh) {
  TetMesh pair = cube;
  for (const Point& p : cube.nodes) pair.nodes.push_back({p[0] + 1, p[1], p[2]});
  const auto shift = Index(cube.nodes.size());
  for (const Tet& t : cube.tets)
    pair.tets.push_back({t[0] + shift, t[1] + shift, t[2] + shift, t[3] + shift});
  const FixedSet one{"one", {0, 1, 3, 4}}, both{"both", {0, 1, 3, shift, shift + 1, shift + 3}};
  EXPECT_EQ(refusal(pair, soft, &one, static_options()).code, IssueCode::compliance_singular);
  EXPECT_TRUE(precompute_compliance(level_of(pair), soft, &both, static_options()).ok());
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
  CompliancePrecomputeOptions options;
  options.memory_limit_bytes = 10000;
  EXPECT_EQ(refusal(cube, soft, nullptr, options).code, IssueCode::compliance_out_of_memory);
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
    const auto variant = precompute_compliance(level_of(mesh), soft, nullptr, {});
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
