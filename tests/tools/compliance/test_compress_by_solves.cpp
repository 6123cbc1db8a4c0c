// SPDX-License-Identifier: GPL-3.0-or-later
// The hierarchical form from solves alone, against the dense inverse.
#include "tools/compliance/compress_by_solves.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <numeric>

#include "runtime/fem/corotational_model.hpp"
#include "tests/support/box_mesh.hpp"
#include "tools/compliance/compliance_probes.hpp"
#include "tools/compliance/hodlr_matrix.hpp"
#include "tools/compliance/node_scale.hpp"
#include "tools/compliance/peeling.hpp"
#include "tools/compliance/selected_inverse.hpp"
#include "tools/compliance/surface_inverse.hpp"

namespace souple {
namespace {

using namespace test;
using Eigen::MatrixXd;
using Eigen::MatrixXf;

/// A block of soft matter with its matrix, its outer nodes and C on them by Eigen.
struct Body {
  std::unique_ptr<const CorotationalModel> model;
  BlockMatrix a0;
  std::vector<Index> free_nodes, surface;
  std::vector<Point> positions;
  MatrixXd c;
};

bool is_outer(const Point& p, const Point& size) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (p[axis] < 1e-9 * size[axis] || p[axis] > (1 - 1e-9) * size[axis]) return true;
  return false;
}

Body make_body(std::array<int, 3> cells, double mass_factor = 10010, double stiffness_factor = 2,
               double unit = 1) {
  const Point size{0.15 * unit, 0.1 * unit, 0.08 * unit};
  const TetMesh mesh = irregular_box_mesh(cells, {0, 0, 0}, size, 0.6);
  auto model = CorotationalModel::create(mesh, material_of(1e4, 0.4, 1000));
  EXPECT_TRUE(model.ok());
  auto kept = std::make_unique<const CorotationalModel>(std::move(*model));
  BlockMatrix a0(kept->pattern());
  Body body{std::move(kept), std::move(a0), {}, {}, {}, {}};
  body.model->assemble_rest(mass_factor, stiffness_factor, body.a0);
  const bool held = mass_factor == 0;
  for (Index node = 0; node < Index(mesh.nodes.size()); ++node) {
    const Point& p = mesh.nodes[std::size_t(node)];
    if (held && p[0] < 1e-9 * unit) continue;
    body.free_nodes.push_back(node);
    if (!is_outer(p, size)) continue;
    body.surface.push_back(node);
    body.positions.push_back(p);
  }
  return body;
}

void invert(Body& body) {
  const BlockPattern& pattern = body.model->pattern();
  std::vector<Index> local(std::size_t(pattern.node_count()), -1);
  for (std::size_t k = 0; k < body.free_nodes.size(); ++k)
    local[std::size_t(body.free_nodes[k])] = Index(k);
  MatrixXd a = MatrixXd::Zero(3 * Eigen::Index(body.free_nodes.size()),
                              3 * Eigen::Index(body.free_nodes.size()));
  for (const Index node : body.free_nodes)
    for (Index b = pattern.row_begin[node]; b < pattern.row_begin[node + 1]; ++b)
      if (const Index other = local[std::size_t(pattern.column[b])]; other >= 0)
        a.block<3, 3>(3 * local[std::size_t(node)], 3 * other) = body.a0.block(b);
  std::vector<Eigen::Index> rows;
  for (const Index node : body.surface)
    for (int c = 0; c < 3; ++c) rows.push_back(3 * local[std::size_t(node)] + c);
  MatrixXd unit = MatrixXd::Zero(a.rows(), Eigen::Index(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k) unit(rows[k], Eigen::Index(k)) = 1;
  body.c = a.llt().solve(unit)(rows, Eigen::all);
}

SolveCompressionOptions options_of(double tolerance, ErrorNorm norm = ErrorNorm::scaled_spectral) {
  SolveCompressionOptions options;
  options.tolerance = tolerance;
  options.norm = norm;
  options.leaf_nodes = 24;
  return options;
}

CompressedBySolves compressed(const Body& body, const SolveCompressionOptions& options) {
  auto result = compress_by_solves(body.a0, body.free_nodes, body.surface, body.positions, options);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : format_issue(result.issue()));
  return result.ok() ? std::move(*result) : CompressedBySolves{};
}

/// S C~ S^T in the order of the rows.
MatrixXd whole(const HodlrMatrix& matrix) {
  const auto n = Index(matrix.order.size());
  MatrixXd scaled = MatrixXd::Zero(3 * n, 3 * n);
  const auto rows_of = [](ClusterRange range) {
    return Eigen::seqN(3 * range.begin, 3 * range.size());
  };
  for (int level = 0; level < matrix.depth; ++level)
    for (Index i = 0; i < Index{1} << level; ++i) {
      const LowRankBlock& block = matrix.blocks[std::size_t(block_of_cluster(level, i))];
      const auto left = rows_of(cluster_range(n, level + 1, 2 * i));
      const auto right = rows_of(cluster_range(n, level + 1, 2 * i + 1));
      scaled(left, right) =
          (block.left * block.singular.asDiagonal() * block.right.transpose()).cast<double>();
      scaled(right, left) = scaled(left, right).transpose().eval();
    }
  for (Index leaf = 0; leaf < Index{1} << matrix.depth; ++leaf) {
    const auto rows = rows_of(cluster_range(n, matrix.depth, leaf));
    scaled(rows, rows) = matrix.leaves[std::size_t(leaf)].cast<double>();
  }
  MatrixXd out(3 * n, 3 * n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const Index row = matrix.order[std::size_t(i)], column = matrix.order[std::size_t(j)];
      out.block<3, 3>(3 * row, 3 * column) =
          scale_matrix<double>(matrix.scale[std::size_t(row)]) * scaled.block<3, 3>(3 * i, 3 * j) *
          scale_matrix<double>(matrix.scale[std::size_t(column)]).transpose();
    }
  return out;
}

double error_of(const MatrixXd& stored, const MatrixXd& exact, ErrorNorm norm) {
  const MatrixXd e = stored - exact;
  if (norm == ErrorNorm::frobenius) return e.norm() / exact.norm();
  if (norm == ErrorNorm::worst_column)
    return (e.colwise().norm().array() / exact.colwise().norm().array()).maxCoeff();
  MatrixXd scaled = e;
  for (Eigen::Index k = 0; k < e.rows(); k += 3) {
    const Eigen::LLT<Mat3> factor(Mat3(exact.block<3, 3>(k, k)));
    scaled.middleRows(k, 3) = factor.matrixL().solve(scaled.middleRows(k, 3).eval());
  }
  for (Eigen::Index k = 0; k < e.rows(); k += 3) {
    const Eigen::LLT<Mat3> factor(Mat3(exact.block<3, 3>(k, k)));
    scaled.middleCols(k, 3) =
        factor.matrixL().solve(scaled.middleCols(k, 3).transpose().eval()).transpose();
  }
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(scaled, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .cwiseAbs()
      .maxCoeff();
}

const Body& free_body() {
  static const Body body = [] {
    Body made = make_body({12, 9, 7});
    invert(made);
    return made;
  }();
  return body;
}

TEST(CompressBySolves, StaysWithinAThirdOfEveryToleranceInEveryNorm) {
  for (const ErrorNorm norm :
       {ErrorNorm::scaled_spectral, ErrorNorm::frobenius, ErrorNorm::worst_column})
    for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4}) {
      const auto result = compressed(free_body(), options_of(tolerance, norm));
      const double error = error_of(whole(result.matrix), free_body().c, norm);
      EXPECT_LE(error, tolerance / 3)
          << "norm " << int(norm) << " tolerance " << tolerance << " refined " << result.report.refined;
      EXPECT_GE(error, tolerance / 200) << "norm " << int(norm) << " tolerance " << tolerance;
    }
}

TEST(CompressBySolves, KeepsToleranceNearTheLimitOfSinglePrecisionVectors) {
  // C~ has norm 60 or so here: vectors in single precision alone take 3e-6 of it.
  const auto result = compressed(free_body(), options_of(1e-5));
  EXPECT_TRUE(result.report.refined);
  EXPECT_LE(error_of(whole(result.matrix), free_body().c, ErrorNorm::scaled_spectral), 1e-5);
}

TEST(CompressBySolves, FollowsAHeldStaticBody) {
  Body body = make_body({12, 6, 6}, 0, 1);
  invert(body);
  const auto result = compressed(body, options_of(1e-3));
  EXPECT_LE(error_of(whole(result.matrix), body.c, ErrorNorm::scaled_spectral), 1e-3 / 3);
}

TEST(CompressBySolves, DoesNotMindTheUnitsOfTheBody) {
  for (const double unit : {1e-3, 1e3}) {
    // The same body in other units of length: M/h^2 goes as unit^3, K as unit.
    Body body = make_body({8, 6, 5}, 10010 / (unit * unit), 2, unit);
    invert(body);
    const auto result = compressed(body, options_of(1e-3));
    EXPECT_LE(error_of(whole(result.matrix), body.c, ErrorNorm::scaled_spectral), 1e-3 / 3) << unit;
  }
}

TEST(CompressBySolves, ALooserToleranceTakesFewerTerms) {
  const auto terms = [](double tolerance) {
    const auto result = compressed(free_body(), options_of(tolerance));
    return std::accumulate(
        result.matrix.blocks.begin(), result.matrix.blocks.end(), Eigen::Index{0},
        [](Eigen::Index sum, const LowRankBlock& block) { return sum + block.singular.size(); });
  };
  const auto loose = terms(1e-1), middle = terms(1e-2), tight = terms(1e-4);
  EXPECT_LT(loose, middle);
  EXPECT_LT(middle, tight);
}

TEST(CompressBySolves, TheOperatorIsTheInverse) {
  const Body& body = free_body();
  const auto result = compressed(body, options_of(1e-2));
  const MatrixXd x = MatrixXd::Random(body.c.cols(), 19);
  MatrixXd y(x.rows(), x.cols());
  result.exact->apply(x, y);
  EXPECT_EQ(result.exact->node_count(), Index(body.surface.size()));
  EXPECT_LE((y - body.c * x).norm() / (body.c * x).norm(), 1e-9);
}

TEST(CompressBySolves, BitsDoNotDependOnTheThreads) {
  const auto bits = [](unsigned threads) {
    SolveCompressionOptions options = options_of(1e-3);
    options.threads = threads;
    return compressed(free_body(), options).matrix;
  };
  const HodlrMatrix one = bits(1), three = bits(3);
  ASSERT_EQ(one.blocks.size(), three.blocks.size());
  EXPECT_EQ(one.order, three.order);
  EXPECT_EQ(one.scale, three.scale);
  for (std::size_t b = 0; b < one.blocks.size(); ++b) {
    ASSERT_EQ(one.blocks[b].singular.size(), three.blocks[b].singular.size());
    EXPECT_EQ(one.blocks[b].left, three.blocks[b].left);
    EXPECT_EQ(one.blocks[b].right, three.blocks[b].right);
  }
  for (std::size_t l = 0; l < one.leaves.size(); ++l) EXPECT_EQ(one.leaves[l], three.leaves[l]);
}

TEST(CompressBySolves, SmallBodiesHaveOneLeaf) {
  Body body = make_body({2, 2, 2});
  invert(body);
  SolveCompressionOptions options = options_of(1e-4);
  options.leaf_nodes = 64;
  const auto result = compressed(body, options);
  EXPECT_EQ(result.matrix.depth, 0);
  ASSERT_EQ(result.matrix.leaves.size(), 1U);
  EXPECT_LE(error_of(whole(result.matrix), body.c, ErrorNorm::scaled_spectral), 1e-4 / 3);
}

TEST(CompressBySolves, StopsWhenItIsTold) {
  const Body& body = free_body();
  std::atomic<int> asked{0};
  SolveCompressionOptions options = options_of(1e-3);
  options.threads = 1;  // with more, how often it asks depends on how they fall
  options.cancelled = [&] {
    ++asked;
    return false;
  };
  compressed(body, options);
  const int whole_run = asked;
  for (const int calls : {0, 3, whole_run / 4, whole_run / 2, whole_run - whole_run / 8}) {
    asked = 0;
    options.cancelled = [&] { return asked++ >= calls; };
    const auto result =
        compress_by_solves(body.a0, body.free_nodes, body.surface, body.positions, options);
    ASSERT_FALSE(result.ok()) << calls;
    EXPECT_EQ(result.issue().code, IssueCode::interrupted);
  }
}

TEST(CompressBySolves, RefusesWhatDoesNotFitTheMemory) {
  const Body& body = free_body();
  const auto planned = compressed(body, options_of(1e-3)).report.planned_bytes;
  for (const std::size_t limit : {std::size_t{1000}, planned / 2, planned - planned / 20}) {
    SolveCompressionOptions options = options_of(1e-3);
    options.memory_limit_bytes = limit;
    const auto result =
        compress_by_solves(body.a0, body.free_nodes, body.surface, body.positions, options);
    ASSERT_FALSE(result.ok()) << limit;
    EXPECT_EQ(result.issue().code, IssueCode::compliance_out_of_memory);
  }
  SolveCompressionOptions options = options_of(1e-3);
  options.memory_limit_bytes = planned;
  EXPECT_TRUE(compress_by_solves(body.a0, body.free_nodes, body.surface, body.positions, options).ok());
}

TEST(CompressBySolves, RefusesBadInputByCode) {
  const Body& body = free_body();
  const auto code = [&](std::span<const Index> surface, std::span<const Point> positions,
                        double tolerance) {
    const auto result =
        compress_by_solves(body.a0, body.free_nodes, surface, positions, options_of(tolerance));
    EXPECT_FALSE(result.ok());
    return result.ok() ? IssueCode::interrupted : result.issue().code;
  };
  const std::vector<Index> stranger{Index(1) << 20};
  const std::vector<Point> one{body.positions[0]};
  EXPECT_EQ(code({}, {}, 1e-3), IssueCode::compliance_region_empty);
  EXPECT_EQ(code(stranger, one, 1e-3), IssueCode::compliance_region_empty);
  EXPECT_EQ(code(body.surface, one, 1e-3), IssueCode::compliance_region_empty);
  for (const double tolerance : {0.0, -1.0, 0.6, std::nan(""), 1e-12})
    EXPECT_EQ(code(body.surface, body.positions, tolerance), IssueCode::compliance_tolerance_missed);
}

TEST(CompressBySolves, ProgressRisesToTheEnd) {
  double last = 0;
  SolveCompressionOptions options = options_of(1e-2);
  options.progress = [&](double fraction) {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1);
    last = fraction;
  };
  compressed(free_body(), options);
  EXPECT_GT(last, 0.9);
}

TEST(SelectedInverse, GivesTheDiagonalBlocks) {
  const Body& body = free_body();
  const auto inverse =
      SurfaceInverse::create(body.a0, body.free_nodes, body.surface, {std::size_t{1} << 30, 1, {}, {}});
  ASSERT_TRUE(inverse.ok());
  const auto blocks = inverse_diagonal_blocks((*inverse)->factor(), (*inverse)->places(), {});
  ASSERT_EQ(blocks.size(), body.surface.size());
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const Mat3 exact = body.c.block<3, 3>(3 * Eigen::Index(k), 3 * Eigen::Index(k));
    EXPECT_LE((blocks[k] / (*inverse)->factor().unit() - exact).norm(), 1e-5 * exact.norm());
  }
}

TEST(SolveProbes, MeasureTheSystemAndNotWhatTheSolverSaysOfItself) {
  const Body& body = free_body();
  const auto inverse =
      SurfaceInverse::create(body.a0, body.free_nodes, body.surface, {std::size_t{1} << 30, 2, {}, {}});
  ASSERT_TRUE(inverse.ok());
  ComplianceSystem system;
  system.pattern = std::make_unique<BlockPattern>(body.model->pattern());
  system.a0 = std::make_unique<BlockMatrix>(*system.pattern);
  system.a0->values = body.a0.values;
  system.free_nodes = body.free_nodes;
  system.nodes = body.surface;
  for (const Index node : body.surface)
    system.chosen.push_back(
        Index(std::ranges::lower_bound(body.free_nodes, node) - body.free_nodes.begin()));
  EXPECT_LE(probe_solves(system, **inverse), 1e-9);
  // Another matrix than the one that was factorised: A u - f = 1e-3 f.
  for (double& value : system.a0->values) value *= 1.001;
  EXPECT_NEAR(probe_solves(system, **inverse), 1e-3, 1e-9);
}

TEST(Peeling, RecoversAHierarchicalMatrixFromProductsAlone) {
  // 1 / (1 + |i - j| / 8): smooth away from the diagonal.
  const Index n = 200;
  MatrixXf a(3 * n, 3 * n);
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < a.cols(); ++j) a(i, j) = 1 / (1 + float(std::abs(i - j)) / 8);
  PeelingProblem problem{n, 3, [&](FloatRef x, unsigned) {
                           x = (a.cast<double>() * x.cast<double>()).cast<float>().eval();
                           return true;
                         }};
  PeelingOptions options;
  options.sampled_bound = options.truncated_bound = 1e-4;
  options.memory_limit_bytes = std::size_t{1} << 30;
  const auto peeled = peel(problem, options);
  ASSERT_TRUE(peeled.ok());
  MatrixXf unit = MatrixXf::Identity(3 * n, 3 * n), rebuilt = MatrixXf::Zero(3 * n, 3 * n);
  add_levels(*peeled, n, 3, 1, unit, rebuilt);
  for (Index leaf = 0; leaf < 8; ++leaf) {
    const ClusterRange range = cluster_range(n, 3, leaf);
    rebuilt.block(3 * range.begin, 3 * range.begin, 3 * range.size(), 3 * range.size()) +=
        peeled->leaves[std::size_t(leaf)];
  }
  EXPECT_LE((rebuilt - a).norm(), 1e-3);
  EXPECT_LE(peeled->sampled_rank[0], 64);
}

}  // namespace
}  // namespace souple
