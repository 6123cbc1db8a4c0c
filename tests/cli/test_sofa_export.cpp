// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <numeric>

#include "formats/read/asset_reader.hpp"
#include "runtime/compliance/open_variant.hpp"
#include "runtime/fem/corotational_model.hpp"
#include "tests/cli/run_souple.hpp"
#include "tests/cli/schema_check.hpp"

namespace souple::test {
namespace {
namespace fs = std::filesystem;
using Eigen::MatrixXd;

class SofaExport : public SoupleCommand {
 protected:
  void SetUp() override { fs::copy_file(baked_liver(), path("liver.souple")); }
  RunResult export_it(std::vector<std::string> more) const {
    std::vector<std::string> words{"export", path("liver.souple").string(), "--to", "sofa-comp"};
    words.insert(words.end(), more.begin(), more.end());
    return run_souple(words);
  }
};

/// As SOFA's loadCompliance does: the length follows from the mechanical state, not from the file.
MatrixXd load_compliance(const fs::path& file, Eigen::Index node_count) {
  const Eigen::Index rows = 3 * node_count;
  std::vector<double> values(static_cast<std::size_t>(rows * rows));
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(values.data()), rows * rows * 8);
  EXPECT_EQ(in.gcount(), rows * rows * 8);
  EXPECT_EQ(in.peek(), std::ifstream::traits_type::eof());
  return Eigen::Map<Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(values.data(), rows, rows);
}

MatrixXd dense(const CorotationalModel& model, double mass_factor, double stiffness_factor) {
  BlockMatrix a(model.pattern());
  model.assemble_rest(mass_factor, stiffness_factor, a);
  MatrixXd full = MatrixXd::Zero(3 * model.node_count(), 3 * model.node_count());
  const BlockPattern& pattern = model.pattern();
  for (Index row = 0; row < model.node_count(); ++row)
    for (Index b = pattern.row_begin[std::size_t(row)]; b < pattern.row_begin[std::size_t(row) + 1];
         ++b)
      full.block<3, 3>(3 * row, 3 * pattern.column[std::size_t(b)]) = a.block(b);
  return full;
}

/// The rows and columns of fixed nodes as a projective constraint leaves them: the identity.
void project(MatrixXd& system, const std::vector<Index>& fixed) {
  for (const Index node : fixed) {
    system.middleRows(3 * node, 3).setZero();
    system.middleCols(3 * node, 3).setZero();
    system.block<3, 3>(3 * node, 3 * node).setIdentity();
  }
}

std::unique_ptr<const RestCompliance> open_stored(const ComplianceVariant& variant) {
  auto stored = open_variant(variant);
  EXPECT_TRUE(stored.ok());
  return stored ? std::move(*stored) : nullptr;
}

TEST_F(SofaExport, HoldsTheVelocityAfterOneImplicitStepUnderUnitForces) {
  const auto result = export_it({"--variant", "held", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(schema_violation(result.json(), load_schema("export")), "");
  auto reader = AssetReader::open(path("liver.souple"));
  ASSERT_TRUE(reader.ok());
  const auto level = reader->read_level(reader->level_count() - 1);
  const auto material = reader->read_material();
  const auto fixed = reader->read_fixed_set("low");
  ASSERT_TRUE(level.ok() && material.ok() && fixed.ok());
  const auto model = CorotationalModel::create(level->mesh, *material);
  ASSERT_TRUE(model.ok());
  const Index nodes = model->node_count();
  const fs::path file = path("liver-" + std::to_string(3 * nodes) + "-0.01.comp");
  EXPECT_EQ(result.json()["output"], file.string());
  const MatrixXd compliance = load_compliance(file, nodes);

  // EulerImplicitSolver: ((1 + h alpha) M + h (h + beta) K) dv = h f, from rest.
  const double h = 0.01, alpha = 0.1, beta = 0.01;
  MatrixXd system = (1 + h * alpha) * dense(*model, 1, 0) + h * (h + beta) * dense(*model, 0, 1);
  project(system, fixed->nodes);
  MatrixXd impulse = h * MatrixXd::Identity(3 * nodes, 3 * nodes);
  for (const Index node : fixed->nodes) impulse.block<3, 3>(3 * node, 3 * node).setZero();
  EXPECT_LT((system * compliance - impulse).norm() / impulse.norm(), 1e-11);
  EXPECT_LT((compliance - compliance.transpose()).norm() / compliance.norm(), 1e-13);
  for (const Index node : fixed->nodes) {
    EXPECT_EQ(compliance.middleRows(3 * node, 3).cwiseAbs().maxCoeff(), 0);
    EXPECT_EQ(compliance.middleCols(3 * node, 3).cwiseAbs().maxCoeff(), 0);
  }
}

TEST_F(SofaExport, AgreesOnTheSurfaceWithWhatTheAssetHolds) {
  auto reader = AssetReader::open(path("liver.souple"));
  ASSERT_TRUE(reader.ok());
  const auto sizes = reader->read_level_sizes(reader->level_count() - 1);
  ASSERT_TRUE(sizes.ok());
  for (const char* name : {"free", "held"}) {
    ASSERT_EQ(export_it({"--variant", name, "-o", path("c.comp").string()}).exit_code, 0);
    const MatrixXd exported = load_compliance(path("c.comp"), Eigen::Index(sizes->node_count));
    auto variant = reader->read_compliance(name);
    ASSERT_TRUE(variant.ok());
    const double worst_column = variant->header.error.worst_column;
    const std::vector<Index> nodes = variant->nodes;
    const auto stored = open_stored(std::move(*variant));
    ASSERT_TRUE(stored);
    std::vector<Index> rows(nodes.size());
    std::iota(rows.begin(), rows.end(), 0);
    ComplianceWork work;
    for (Index row = 0; row < stored->row_count(); row += 9) {
      std::vector<double> motion(3 * rows.size());
      const std::array<double, 3> force{0, 1, 0};
      stored->apply({&row, 1}, force, motion, work);
      double difference = 0, norm = 0;
      for (std::size_t k = 0; k < motion.size(); ++k) {
        const double exact =
            0.01 * exported(3 * nodes[k / 3] + Eigen::Index(k % 3), 3 * nodes[std::size_t(row)] + 1);
        difference += (motion[k] - exact) * (motion[k] - exact);
        norm += exact * exact;
      }
      EXPECT_LE(std::sqrt(difference / norm), worst_column + 1e-6) << name << " " << row;
    }
  }
}

TEST_F(SofaExport, MovesAFreeBodyAsAWhole) {
  ASSERT_EQ(export_it({"--variant", "free", "-o", path("c.comp").string()}).exit_code, 0);
  auto reader = AssetReader::open(path("liver.souple"));
  ASSERT_TRUE(reader.ok());
  const auto level = reader->read_level(reader->level_count() - 1);
  ASSERT_TRUE(level.ok());
  const auto model = CorotationalModel::create(level->mesh, *reader->read_material());
  ASSERT_TRUE(model.ok());
  // A unit impulse, spread over the nodes by their mass m_i / m, moves all of them by h / m (1 + alpha
  // h).
  Eigen::VectorXd push = Eigen::VectorXd::Zero(3 * model->node_count());
  for (Index node = 0; node < model->node_count(); ++node)
    push[3 * node] = model->masses()[std::size_t(node)] / model->total_mass();
  const Eigen::VectorXd moved = load_compliance(path("c.comp"), model->node_count()) * push;
  const double h = 0.01, expected = h / (model->total_mass() * (1 + 0.1 * h));
  for (Index node = 0; node < model->node_count(); ++node) {
    EXPECT_NEAR(moved[3 * node], expected, 1e-9 * expected);
    EXPECT_NEAR(moved[3 * node + 1], 0, 1e-9 * expected);
  }
}

TEST_F(SofaExport, RefusesWhatHasNoPlaceInTheForm) {
  const auto before = names();
  const auto several = export_it({});
  expect_issue(several, 1, "S1004");
  EXPECT_NE(several.err.find("held"), std::string::npos) << several.err;
  expect_issue(export_it({"--variant", "nobody"}), 3, "S3202");
  expect_issue(export_it({"--variant", "held", "--level", "0"}), 1, "S1004");
  expect_issue(export_it({"--variant", "held", "--visual"}), 1, "S1004");
  expect_issue(
      run_souple({"export", path("liver.souple").string(), "--to", "msh", "--variant", "held"}), 1,
      "S1004");
  const auto recipe = write(
      "r.toml", "[[compliance]]\nname = \"s\"\nkind = \"static\"\nfixed = \"low\"\ntolerance = 0\n");
  ASSERT_EQ(run_souple({"precompute", path("liver.souple").string(), "--recipe", recipe.string(), "-o",
                        path("static.souple").string()})
                .exit_code,
            0);
  expect_issue(run_souple({"export", path("static.souple").string(), "--to", "sofa-comp"}), 3, "S3492");
  fs::remove(path("static.souple"));
  fs::remove(recipe);
  EXPECT_EQ(names(), before);
}

TEST_F(SofaExport, AFullDiskLeavesNothing) {
  const auto before = names();
  RunOptions options;
  options.file_size_limit = 100000;
  const auto result = run_souple(
      {"export", path("liver.souple").string(), "--to", "sofa-comp", "--variant", "free"}, options);
  expect_issue(result, 2, "S2003");
  EXPECT_EQ(names(), before);
}

}  // namespace
}  // namespace souple::test
