// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"

namespace souple {
namespace {

struct Fixture {
  TetMesh mesh = test::irregular_box_mesh({4, 3, 3}, {0, 0, 0}, {0.2, 0.15, 0.15}, 1.0);
  Material material = test::material_of(1e4, 0.4, 1000, 0.1, 0.01);
  double h = 0.01;
  std::vector<Index> fixed;
  std::shared_ptr<const SoftBodyAsset> body;
  Eigen::MatrixXd full;

  explicit Fixture(bool clamped) {
    std::vector<FixedSet> sets;
    for (Index n = 0; n < Index(mesh.nodes.size()); ++n)
      if (clamped && mesh.nodes[std::size_t(n)][0] == 0) fixed.push_back(n);
    if (clamped) sets.push_back({"left", fixed});
    body = test::make_body(mesh, material, h, sets, clamped ? "left" : "");
    full = test::dense_compliance(mesh, material, 1 / (h * h) + 0.1 / h, 1 + 0.01 / h, fixed);
  }
  const BodyCompliance& compliance() const { return body->compliances()[0]; }
};

TEST(RestCompliance, GathersAnySelectionInAnyOrder) {
  const Fixture f(false);
  std::vector<Index> rows{40, 3, 17, 16, 15, 0, 3};
  std::vector<double> block(9 * rows.size() * rows.size());
  f.compliance().rest->gather(rows, block);
  for (std::size_t i = 0; i < 3 * rows.size(); ++i)
    for (std::size_t j = 0; j < 3 * rows.size(); ++j) {
      const auto at = [&](std::size_t k) {
        return Eigen::Index(3 * std::size_t(f.compliance().nodes[std::size_t(rows[k / 3])]) + k % 3);
      };
      EXPECT_NEAR(block[i * 3 * rows.size() + j], f.full(at(i), at(j)), 1e-15);
    }
}

TEST(RestCompliance, AppliesLikeTheDenseInverseOnAllNodes) {
  for (const bool clamped : {false, true}) {
    const Fixture f(clamped);
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    std::vector<Index> rows{1, 5, 20, 33, 50};
    std::vector<double> force(3 * rows.size()), surface(3 * f.compliance().nodes.size());
    Eigen::VectorXd load = Eigen::VectorXd::Zero(f.full.rows());
    for (std::size_t k = 0; k < force.size(); ++k) {
      force[k] = normal(random);
      load[3 * f.compliance().nodes[std::size_t(rows[k / 3])] + Eigen::Index(k % 3)] = force[k];
    }
    ComplianceWork scratch;
    f.compliance().rest->apply(rows, force, surface, scratch);
    Eigen::VectorXd u = Eigen::VectorXd::Zero(f.full.rows());
    for (std::size_t k = 0; k < surface.size(); ++k)
      u[3 * f.compliance().nodes[k / 3] + Eigen::Index(k % 3)] = surface[k];
    std::vector<float> work(f.compliance().extension.work_size());
    f.compliance().extension.apply(u, work);
    const Eigen::VectorXd expected = f.full * load;
    for (const Index node : f.compliance().nodes) {
      EXPECT_LT((node_entry(u, node) - node_entry(expected, node)).norm(), 1e-12 * expected.norm());
      node_entry(u, node) = node_entry(expected, node);
    }
    // The interior comes from a factor in half precision.
    EXPECT_LT((u - expected).cwiseAbs().maxCoeff(), 1e-3 * expected.cwiseAbs().maxCoeff())
        << "clamped " << clamped;
  }
}

TEST(RestCompliance, RefusesBlocksThatDoNotFitTheHeader) {
  const Fixture f(false);
  ComplianceHeader header = f.compliance().header;
  header.block_count += 1;
  const auto opened = open_rest_compliance(
      header, {}, std::make_unique<MemoryBlockSource>(std::vector<std::byte>{}, 8));
  ASSERT_FALSE(opened.ok());
  EXPECT_EQ(opened.issue().code, IssueCode::asset_corrupt);
}

TEST(SoftBodyAsset, FindsAComplianceByTheRatioOfItsFactors) {
  const Fixture f(false);
  const auto& header = f.compliance().header;
  EXPECT_EQ(f.body->find_compliance(header.mass_factor, header.stiffness_factor, ""), &f.compliance());
  EXPECT_EQ(f.body->find_compliance(3 * header.mass_factor, 3 * header.stiffness_factor, ""),
            &f.compliance());
  EXPECT_EQ(f.body->find_compliance(2 * header.mass_factor, header.stiffness_factor, ""), nullptr);
  EXPECT_EQ(f.body->find_compliance(header.mass_factor, header.stiffness_factor, "left"), nullptr);
}

TEST(SoftBodyAsset, RefusesInconsistentContent) {
  const auto code_of = [](auto spoil) {
    SoftBodyContent content = test::make_content(test::box_mesh({2, 2, 2}, {0, 0, 0}, {1, 1, 1}),
                                                 test::material_of(1e4, 0.4, 1000), 0.01);
    spoil(content);
    const auto body = SoftBodyAsset::create(std::move(content));
    return body ? IssueCode{} : body.issue().code;
  };
  EXPECT_EQ(code_of([](auto&) {}), IssueCode{});
  EXPECT_EQ(code_of([](auto& c) { c.level.boundary[0][1] = 1000; }), IssueCode::mesh_element_invalid);
  EXPECT_EQ(code_of([](auto& c) {
              c.fixed_sets.push_back({"x", {3, 2}});
            }),
            IssueCode::fixed_set_invalid);
  EXPECT_EQ(code_of([](auto& c) { c.compliances[0].nodes[0] = -1; }), IssueCode::asset_corrupt);
  EXPECT_EQ(code_of([](auto& c) { c.compliances[0].nodes.pop_back(); }), IssueCode::asset_corrupt);
  EXPECT_EQ(code_of([](auto& c) { c.compliances[0].header.fixed_set = "none"; }),
            IssueCode::asset_corrupt);
}

}  // namespace
}  // namespace souple
