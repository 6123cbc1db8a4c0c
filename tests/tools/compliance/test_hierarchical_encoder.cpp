// SPDX-License-Identifier: GPL-3.0-or-later
// From a dense compliance to records and back through the runtime, measured here by other means than
// the encoder's own.
#include "tools/compliance/hierarchical_encoder.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <random>
#include <sstream>

#include "runtime/compliance/record_model.hpp"
#include "runtime/compliance/rest_compliance.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/tools/compliance/dense_source.hpp"
#include "tools/compliance/hodlr_factor.hpp"
#include "tools/compliance/range_encoder.hpp"

namespace souple {
namespace {

using Eigen::MatrixXd;
using test::DenseSource;

/// The compliance of a body on its surface.
struct Body {
  std::vector<Point> positions;
  MatrixXd c;
};

// Dynamic, h = 0.01 s, free; the reference material.
Body make_body(const TetMesh& mesh) {
  const Material material = test::material_of(1e4, 0.4, 1000, 0.1, 0.01);
  const MatrixXd full = test::dense_compliance(mesh, material, 1e4 + 10, 2, {});
  Body body;
  const std::vector<Index> surface = used_nodes(boundary_triangles(mesh.tets));
  body.c.resize(3 * Eigen::Index(surface.size()), 3 * Eigen::Index(surface.size()));
  for (std::size_t a = 0; a < surface.size(); ++a) {
    body.positions.push_back(mesh.nodes[std::size_t(surface[a])]);
    for (std::size_t b = 0; b < surface.size(); ++b)
      body.c.block<3, 3>(3 * Eigen::Index(a), 3 * Eigen::Index(b)) =
          full.block<3, 3>(3 * surface[a], 3 * surface[b]);
  }
  return body;
}

const Body& box() {
  static const Body body =
      make_body(test::irregular_box_mesh({9, 5, 4}, {0, 0, 0}, {0.16, 0.09, 0.08}, 0.5));
  return body;
}

std::filesystem::path data_folder() {
  const char* folder = std::getenv("SOUPLE_DATA_DIR");
  return folder ? folder : SOUPLE_DEFAULT_DATA_DIR;
}

std::vector<std::vector<double>> numbers_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    std::istringstream text(line);
    std::vector<double> row;
    for (double value = 0; text >> value;) row.push_back(value);
    if (!row.empty()) rows.push_back(std::move(row));
  }
  return rows;
}

// armadillo_4k: 1180 nodes, 1053 of them on the surface; scaled to a diagonal of 0.2 m.
TetMesh armadillo() {
  const auto nodes = numbers_of(data_folder() / "tets" / "armadillo_4k.node");
  const auto tets = numbers_of(data_folder() / "tets" / "armadillo_4k.ele");
  TetMesh mesh;
  if (nodes.empty() || tets.empty()) return mesh;
  Eigen::Vector3d low(1e30, 1e30, 1e30), high = -low;
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    const Eigen::Vector3d p(nodes[k][1], nodes[k][2], nodes[k][3]);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    const Eigen::Vector3d p(nodes[k][1], nodes[k][2], nodes[k][3]);
    mesh.nodes.push_back(as_point((p - low) * (0.2 / (high - low).norm())));
  }
  for (std::size_t k = 1; k < tets.size(); ++k)
    mesh.tets.push_back({Index(tets[k][1]), Index(tets[k][2]), Index(tets[k][3]), Index(tets[k][4])});
  for (Tet& tet : mesh.tets) {
    const auto at = [&](int i) { return mesh.nodes[std::size_t(tet[std::size_t(i)])]; };
    if (signed_volume6(at(0), at(1), at(2), at(3)) < 0) std::swap(tet[2], tet[3]);
  }
  return mesh;
}

EncodeOptions options_of(double tolerance, ErrorNorm norm, Index leaf_nodes = 32) {
  EncodeOptions options;
  options.tolerance = tolerance;
  options.norm = norm;
  options.leaf_nodes = leaf_nodes;
  return options;
}

Result<EncodedCompliance> encode(const Body& body, const EncodeOptions& options) {
  const DenseSource source(body.c);
  const auto hodlr = compress_dense(source, body.positions, options);
  if (!hodlr) return hodlr.issue();
  return encode_hierarchical(*hodlr, static_cast<const SymmetricSource&>(source), options);
}

MatrixXd decode(const EncodedCompliance& encoded) {
  ComplianceHeader header;
  header.representation = ComplianceRepresentation::hierarchical;
  header.node_count = std::int64_t(encoded.index.order.size());
  header.shift = encoded.shift;
  const auto opened = open_rest_compliance(
      header, encoded.index,
      std::make_unique<MemoryBlockSource>(encoded.payload, encoded.index.record_begin));
  EXPECT_TRUE(opened.ok()) << opened.issue().what;
  std::vector<Index> rows(encoded.index.order.size());
  std::iota(rows.begin(), rows.end(), Index{0});
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> c(3 * rows.size(),
                                                                           3 * rows.size());
  (*opened)->gather(rows, {c.data(), std::size_t(c.size())});
  return c;
}

// L^-1 a L^-T, L the Cholesky factors of the diagonal blocks of c.
MatrixXd scaled_by_diagonal(MatrixXd a, const MatrixXd& c) {
  for (Eigen::Index k = 0; k < c.rows(); k += 3) {
    const Eigen::Matrix3d l = c.block<3, 3>(k, k).llt().matrixL();
    const Eigen::Matrix3d inverse = l.inverse();
    a.middleRows<3>(k) = (inverse * a.middleRows<3>(k)).eval();
    a.middleCols<3>(k) = (a.middleCols<3>(k) * inverse.transpose()).eval();
  }
  return a;
}

double spectral_norm(const MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(symmetric, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .cwiseAbs()
      .maxCoeff();
}

// From below, for matrices that are too large for all their eigenvalues.
double power_iteration(const MatrixXd& symmetric) {
  Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(symmetric.rows(), 1, 2).array().sin();
  double value = 0;
  for (int k = 0; k < 60; ++k) {
    x.normalize();
    x = (symmetric * x).eval();
    value = x.norm();
  }
  return value;
}

ComplianceError true_error(const MatrixXd& c, const MatrixXd& decoded) {
  const MatrixXd e = c - decoded;
  ComplianceError error;
  error.frobenius = e.norm() / c.norm();
  error.worst_column = e.colwise().norm().cwiseQuotient(c.colwise().norm()).maxCoeff();
  const MatrixXd scaled = scaled_by_diagonal(e, c);
  error.scaled_spectral = c.rows() < 1500 ? spectral_norm(scaled) : power_iteration(scaled);
  return error;
}

double in_norm(const ComplianceError& error, ErrorNorm norm) {
  return norm == ErrorNorm::frobenius      ? error.frobenius
         : norm == ErrorNorm::worst_column ? error.worst_column
                                           : error.scaled_spectral;
}

// Positive semi-definite up to the rounding of single precision.
void expect_positive(const MatrixXd& decoded, const MatrixXd& c) {
  const MatrixXd scaled = scaled_by_diagonal(decoded, c);
  const double rounding = 1e-6 * power_iteration(scaled);
  const MatrixXd raised = scaled + rounding * MatrixXd::Identity(c.rows(), c.cols());
  EXPECT_EQ(raised.llt().info(), Eigen::Success);
}

constexpr ErrorNorm norms[] = {ErrorNorm::scaled_spectral, ErrorNorm::frobenius,
                               ErrorNorm::worst_column};

TEST(RangeCoder, GivesBackWhatWasWritten) {
  std::mt19937 random(5);
  std::vector<AdaptiveBit> models(8);
  std::vector<std::uint32_t> bits;
  RangeEncoder encoder;
  for (int k = 0; k < 50000; ++k) {
    bits.push_back(k < 20000 ? (random() % 100 == 0) : k < 30000 ? 1 : random() % 4096);
    if (k < 40000)
      (void)encoder.bit(models[std::size_t(k % 8)], bits.back() & 1);
    else
      (void)encoder.direct(12, bits.back());
  }
  const auto bytes = encoder.finish();
  RangeDecoder decoder(bytes);
  std::vector<AdaptiveBit> again(8);
  for (int k = 0; k < 50000; ++k) {
    if (k < 40000)
      ASSERT_EQ(decoder.bit(again[std::size_t(k % 8)]), bits[std::size_t(k)] & 1) << k;
    else
      ASSERT_EQ(decoder.direct(12), bits[std::size_t(k)]) << k;
  }
  // 20000 bits with 0.08 bits of entropy, 10000 certain ones, 10000 even ones and 120000 direct ones.
  // What is beyond 2 % would not be learning: probabilities come from 60 bits, and change three times.
  EXPECT_LT(double(bytes.size()), 1.02 * (1616 + 10000 + 120000) / 8);
}

TEST(RecordModel, CodesTheLargestIntegers) {
  HierarchicalIndex index;
  index.depth = 1;
  index.rank = {2};
  index.step = {1e-3F};
  index.singular = {100, 1e-3F};
  const auto shapes = record_shapes(index, 9);
  std::mt19937 random(2);
  LeafIntegers written;
  for (int k = 0; k < 12 * 13 / 2; ++k) written.diagonal.push_back(k % 2 ? (1 << 29) : -(1 << 29));
  for (int k = 0; k < 24; ++k)
    written.factors.push_back(int(random() >> (1 + k)) * (k % 2 ? 1 : -1) / 4);
  const LeafIntegers expected = written;
  std::vector<std::uint32_t> scratch;
  RangeEncoder encoder;
  RecordModel<RangeEncoder>(encoder, index, scratch).code(shapes[0], written);
  const auto bytes = encoder.finish();
  LeafIntegers read{std::vector<std::int32_t>(78), std::vector<std::int32_t>(24)};
  RangeDecoder decoder(bytes);
  RecordModel<RangeDecoder>(decoder, index, scratch).code(shapes[0], read);
  EXPECT_EQ(read.diagonal, expected.diagonal);
  EXPECT_EQ(read.factors, expected.factors);
}

TEST(HierarchicalEncoder, KeepsEveryToleranceAndIsNotThreeTimesTighter) {
  for (const ErrorNorm norm : norms)
    for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5}) {
      const auto encoded = encode(box(), options_of(tolerance, norm));
      ASSERT_TRUE(encoded.ok()) << tolerance << " " << encoded.issue().what;
      const ComplianceError error = true_error(box().c, decode(*encoded));
      const double measured = in_norm(error, norm);
      EXPECT_LE(measured, tolerance) << int(norm);
      EXPECT_GT(measured, tolerance / 3) << int(norm);
      EXPECT_NEAR(in_norm(encoded->error, norm) / measured, 1, 0.05) << int(norm) << " " << tolerance;
    }
}

TEST(HierarchicalEncoder, CertifiesAllThreeErrors) {
  for (const ErrorNorm norm : norms) {
    const auto encoded = encode(box(), options_of(1e-3, norm));
    ASSERT_TRUE(encoded.ok());
    const ComplianceError error = true_error(box().c, decode(*encoded));
    EXPECT_NEAR(encoded->error.frobenius / error.frobenius, 1, 0.01);
    EXPECT_NEAR(encoded->error.worst_column / error.worst_column, 1, 0.01);
    EXPECT_GE(encoded->error.scaled_spectral, error.scaled_spectral);
    EXPECT_LT(encoded->error.scaled_spectral, 1.05 * error.scaled_spectral);
  }
}

TEST(HierarchicalEncoder, KeepsARealBodyPositiveAndWithinItsTolerance) {
  const TetMesh mesh = armadillo();
  if (mesh.tets.empty()) {
    if (std::getenv("CI") != nullptr) FAIL() << "no data at " << data_folder();
    GTEST_SKIP() << "no data at " << data_folder();
  }
  const Body body = make_body(mesh);
  for (const auto& [norm, tolerance] :
       {std::pair(ErrorNorm::worst_column, 1e-1), std::pair(ErrorNorm::frobenius, 1e-3),
        std::pair(ErrorNorm::scaled_spectral, 1e-2)}) {
    const auto encoded = encode(body, options_of(tolerance, norm));
    ASSERT_TRUE(encoded.ok()) << encoded.issue().what;
    const MatrixXd decoded = decode(*encoded);
    const ComplianceError error = true_error(body.c, decoded);
    EXPECT_LE(in_norm(error, norm), tolerance);
    EXPECT_GT(in_norm(error, norm), tolerance / 3);
    EXPECT_GE(encoded->error.scaled_spectral, error.scaled_spectral);
    expect_positive(decoded, body.c);
  }
}

TEST(HierarchicalEncoder, StaysPositiveAtCoarseTolerances) {
  for (const ErrorNorm norm : norms)
    for (const double tolerance : {0.5, 0.1}) {
      const auto encoded = encode(box(), options_of(tolerance, norm));
      ASSERT_TRUE(encoded.ok());
      expect_positive(decode(*encoded), box().c);
    }
}

TEST(HierarchicalEncoder, IsShiftedOnlyWhereItWouldNotBePositive) {
  const auto fine = encode(box(), options_of(1e-4, ErrorNorm::scaled_spectral));
  ASSERT_TRUE(fine.ok());
  EXPECT_EQ(fine->shift, 0);
  expect_positive(decode(*fine), box().c);
  // Nearly singular, by less of the diagonal blocks.
  Body body = box();
  const double least =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(scaled_by_diagonal(body.c, body.c)).eigenvalues()[0];
  for (Eigen::Index k = 0; k < body.c.rows(); k += 3)
    body.c.block<3, 3>(k, k) -= 0.999 * least * box().c.block<3, 3>(k, k);
  auto coarse = encode(body, options_of(0.3, ErrorNorm::scaled_spectral));
  ASSERT_TRUE(coarse.ok());
  EXPECT_GT(coarse->shift, 0);
  expect_positive(decode(*coarse), body.c);
  coarse->shift = 0;
  EXPECT_NE(scaled_by_diagonal(decode(*coarse), body.c).llt().info(), Eigen::Success);
}

TEST(HierarchicalEncoder, StopsWhenItIsCancelled) {
  const DenseSource source(box().c);
  EncodeOptions options = options_of(1e-3, ErrorNorm::frobenius);
  const auto hodlr = compress_dense(source, box().positions, options);
  ASSERT_TRUE(hodlr.ok());
  options.cancelled = [] { return true; };
  const auto compressed = compress_dense(source, box().positions, options);
  ASSERT_FALSE(compressed.ok());
  EXPECT_EQ(compressed.issue().code, IssueCode::interrupted);
  const auto encoded =
      encode_hierarchical(*hodlr, static_cast<const SymmetricSource&>(source), options);
  ASSERT_FALSE(encoded.ok());
  EXPECT_EQ(encoded.issue().code, IssueCode::interrupted);
}

/// A symmetric matrix in HODLR form of about 4 levels: identity plus smooth low-rank blocks.
ScaledHodlr smooth_hodlr(Index nodes, int depth, double size) {
  ScaledHodlr matrix;
  matrix.node_count = nodes;
  matrix.depth = depth;
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  const auto filled = [&](Index count, Eigen::Index columns) {
    MatrixXd m(3 * Eigen::Index{count}, columns);
    for (double& value : m.reshaped()) value = size * normal(random) / std::sqrt(double(m.rows()));
    return m;
  };
  for (int d = 0; d < depth; ++d)
    for (Index i = 0; i < (Index{1} << d); ++i)
      matrix.blocks.push_back({filled(cluster_range(nodes, d + 1, 2 * i).size(), d == 1 ? 0 : 5),
                               filled(cluster_range(nodes, d + 1, 2 * i + 1).size(), d == 1 ? 0 : 5)});
  for (Index leaf = 0; leaf < (Index{1} << depth); ++leaf) {
    const Eigen::Index rows = 3 * Eigen::Index{cluster_range(nodes, depth, leaf).size()};
    matrix.leaves.push_back(MatrixXd::Identity(rows, rows));
  }
  return matrix;
}

MatrixXd dense_of(const ScaledHodlr& matrix) {
  const Eigen::Index rows = 3 * Eigen::Index{matrix.node_count};
  MatrixXd dense = MatrixXd::Zero(rows, rows);
  const auto rows_of = [](ClusterRange range) {
    return Eigen::seqN(3 * range.begin, 3 * range.size());
  };
  for (int d = 0; d < matrix.depth; ++d)
    for (Index i = 0; i < (Index{1} << d); ++i) {
      const auto& block = matrix.blocks[std::size_t(block_of_cluster(d, i))];
      const auto left = rows_of(cluster_range(matrix.node_count, d + 1, 2 * i));
      const auto right = rows_of(cluster_range(matrix.node_count, d + 1, 2 * i + 1));
      dense(left, right) = block.left * block.right.transpose();
      dense(right, left) = block.right * block.left.transpose();
    }
  for (Index leaf = 0; leaf < (Index{1} << matrix.depth); ++leaf) {
    const auto own = rows_of(cluster_range(matrix.node_count, matrix.depth, leaf));
    dense(own, own) = matrix.leaves[std::size_t(leaf)];
  }
  return dense;
}

TEST(HodlrFactor, SolvesLikeTheDenseMatrix) {
  WorkerPool pool(2);
  for (const int depth : {0, 1, 4}) {
    const ScaledHodlr matrix = smooth_hodlr(75, depth, 0.5);
    const auto factor = HodlrFactor::create(matrix, 0.25, pool);
    ASSERT_TRUE(factor.has_value());
    const MatrixXd dense = dense_of(matrix) + 0.25 * MatrixXd::Identity(225, 225);
    const MatrixXd expected = MatrixXd::Random(225, 3);
    MatrixXd x = dense * expected;
    factor->solve(x);
    EXPECT_LT((x - expected).norm(), 1e-12 * expected.norm());
  }
}

TEST(HodlrFactor, FindsTheShiftThatMakesAMatrixPositive) {
  WorkerPool pool(2);
  for (const double size : {0.5, 1.5, 3.0, 20.0}) {
    const ScaledHodlr matrix = smooth_hodlr(75, 4, size);
    const double least = Eigen::SelfAdjointEigenSolver<MatrixXd>(dense_of(matrix)).eigenvalues()[0];
    const double needed = std::max(0.0, -least), resolution = 0.01;
    EXPECT_EQ(HodlrFactor::create(matrix, 0, pool).has_value(), least > 0);
    const double shift = least_positive_shift(matrix, resolution, pool);
    EXPECT_GE(shift, needed);
    EXPECT_LE(shift, needed + 3 * resolution) << size;
    if (needed > 0) {
      EXPECT_FALSE(HodlrFactor::create(matrix, needed * (1 - 1e-9), pool).has_value());
      EXPECT_TRUE(HodlrFactor::create(matrix, needed * (1 + 1e-9), pool).has_value());
    }
  }
}

TEST(HierarchicalEncoder, TakesTinyBodies) {
  std::mt19937 random(4);
  for (const Index nodes : {1, 2, 3, 5, 31, 33, 64}) {
    Body body;
    body.c = box().c.topLeftCorner(3 * nodes, 3 * nodes);
    body.positions.assign(box().positions.begin(), box().positions.begin() + nodes);
    for (const ErrorNorm norm : norms) {
      const auto encoded = encode(body, options_of(1e-3, norm));
      ASSERT_TRUE(encoded.ok()) << nodes << " " << encoded.issue().what;
      EXPECT_EQ(encoded->index.depth, nodes < 33 ? 0 : 1);
      EXPECT_EQ(fault_of(encoded->index, nodes, encoded->payload.size()), "");
      EXPECT_LE(in_norm(true_error(body.c, decode(*encoded)), norm), 1e-3) << nodes;
    }
  }
}

TEST(HierarchicalEncoder, GivesTheSameBytesWithAnyNumberOfThreads) {
  EncodeOptions options = options_of(1e-3, ErrorNorm::worst_column);
  options.threads = 1;
  const auto one = encode(box(), options);
  options.threads = 5;
  const auto five = encode(box(), options);
  ASSERT_TRUE(one.ok() && five.ok());
  EXPECT_EQ(one->payload, five->payload);
  EXPECT_EQ(one->index.singular, five->index.singular);
  EXPECT_EQ(one->shift, five->shift);
  EXPECT_EQ(one->error.scaled_spectral, five->error.scaled_spectral);
}

TEST(HierarchicalEncoder, TurnsWithTheBody) {
  const Eigen::Matrix3d r =
      Eigen::AngleAxisd(0.9, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  Body turned = box();
  for (Point& p : turned.positions) p = as_point(r * as_vec3(p));
  for (Eigen::Index k = 0; k < turned.c.rows(); k += 3) {
    turned.c.middleRows<3>(k) = (r * turned.c.middleRows<3>(k)).eval();
  }
  for (Eigen::Index k = 0; k < turned.c.rows(); k += 3)
    turned.c.middleCols<3>(k) = (turned.c.middleCols<3>(k) * r.transpose()).eval();
  const auto straight = encode(box(), options_of(1e-3, ErrorNorm::frobenius));
  const auto oblique = encode(turned, options_of(1e-3, ErrorNorm::frobenius));
  ASSERT_TRUE(straight.ok() && oblique.ok());
  EXPECT_LT(true_error(turned.c, decode(*oblique)).frobenius, 1e-3);
  EXPECT_NEAR(double(oblique->payload.size()) / double(straight->payload.size()), 1, 0.15);
}

TEST(HierarchicalEncoder, DoesNotDependOnUnits) {
  const auto metres = encode(box(), options_of(1e-3, ErrorNorm::scaled_spectral));
  ASSERT_TRUE(metres.ok());
  for (const double factor : {1e-9, 1e9}) {
    Body body = box();
    body.c *= factor;
    const auto scaled = encode(body, options_of(1e-3, ErrorNorm::scaled_spectral));
    ASSERT_TRUE(scaled.ok()) << scaled.issue().what;
    EXPECT_LE(true_error(body.c, decode(*scaled)).scaled_spectral, 1e-3);
    EXPECT_NEAR(double(scaled->payload.size()) / double(metres->payload.size()), 1, 0.02);
  }
}

TEST(HierarchicalEncoder, MeasuresAgainstAnOperatorToo) {
  const DenseSource source(box().c);
  for (const auto& [norm, factor_limit] : {std::pair(ErrorNorm::scaled_spectral, std::size_t{1} << 30),
                                           {ErrorNorm::scaled_spectral, 0},
                                           {ErrorNorm::frobenius, std::size_t{1} << 30},
                                           {ErrorNorm::frobenius, 0},
                                           {ErrorNorm::worst_column, std::size_t{1} << 30},
                                           {ErrorNorm::worst_column, 0}}) {
    EncodeOptions options = options_of(1e-3, norm);
    options.factor_limit_bytes = factor_limit;
    const auto hodlr = compress_dense(source, box().positions, options);
    ASSERT_TRUE(hodlr.ok());
    const auto encoded =
        encode_hierarchical(*hodlr, static_cast<const SymmetricOperator&>(source), options);
    ASSERT_TRUE(encoded.ok()) << encoded.issue().what;
    const MatrixXd decoded = decode(*encoded);
    const ComplianceError error = true_error(box().c, decoded);
    EXPECT_LE(in_norm(error, norm), 1e-3);
    EXPECT_GT(in_norm(error, norm), 1e-3 / 3);
    EXPECT_GE(encoded->error.scaled_spectral, error.scaled_spectral);
    EXPECT_GE(encoded->error.frobenius, error.frobenius);
    EXPECT_GE(encoded->error.worst_column, error.worst_column);
    expect_positive(decoded, box().c);
  }
}

TEST(HierarchicalEncoder, RefusesTolerancesItCannotReach) {
  for (const double tolerance : {0.0, -1.0, 0.6, 1e-12, std::nan("")}) {
    const auto encoded = encode(box(), options_of(tolerance, ErrorNorm::scaled_spectral));
    ASSERT_FALSE(encoded.ok()) << tolerance;
    EXPECT_EQ(encoded.issue().code, IssueCode::compliance_tolerance_missed);
  }
}

TEST(HierarchicalEncoder, RefusesAMatrixThatIsNoCompliance) {
  Body body = box();
  body.c(4, 4) = -1;
  const auto negative = encode(body, options_of(1e-3, ErrorNorm::scaled_spectral));
  ASSERT_FALSE(negative.ok());
  EXPECT_EQ(negative.issue().code, IssueCode::compliance_factorisation_failed);
  body.c(200, 7) = body.c(7, 200) = std::nan("");
  for (const ErrorNorm norm : norms) EXPECT_FALSE(encode(body, options_of(1e-3, norm)).ok());
}

TEST(ClusterOrder, HalvesAlongTheLargestSpread) {
  std::vector<Point> line;
  for (int k = 0; k < 10; ++k) line.push_back({0.1 * ((7 * k) % 10), 0.01, 0});
  const auto order = cluster_order(line);
  ASSERT_EQ(order.size(), 10U);
  const auto x_at = [&](int k) { return line[std::size_t(order[std::size_t(k)])][0]; };
  for (int k = 2; k < 10; ++k)  // one way or the other
    EXPECT_GT((x_at(k) - x_at(k - 1)) * (x_at(1) - x_at(0)), 0);
  EXPECT_EQ(cluster_depth(64, 64), 0);
  EXPECT_EQ(cluster_depth(65, 64), 1);
  EXPECT_EQ(cluster_depth(1, 64), 0);
}

}  // namespace
}  // namespace souple
