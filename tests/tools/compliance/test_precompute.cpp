// SPDX-License-Identifier: GPL-3.0-or-later
// References 1.4, against a dense inverse that was assembled another way.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numeric>

#include "runtime/compliance/open_variant.hpp"
#include "runtime/fem/corotational_model.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tools/compliance/precompute.hpp"

namespace souple {
namespace {

using namespace test;

const TetMesh block = irregular_box_mesh({5, 4, 3}, {0, 0, 0}, {0.2, 0.16, 0.12}, 1);
const Material soft = material_of(1e4, 0.4, 1000, 0.1, 0.01);

FixedSet left_of(const TetMesh& mesh, double x = 1e-9) {
  FixedSet set{"left", {}};
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (mesh.nodes[n][0] <= x) set.nodes.push_back(Index(n));
  return set;
}

// The dense form, exact to its scalars.
CompliancePrecomputeOptions dynamic_options(ScalarType scalar = ScalarType::float64) {
  CompliancePrecomputeOptions options;
  options.scalar = scalar;
  options.tolerance = 0;
  return options;
}

CompliancePrecomputeOptions static_options() {
  CompliancePrecomputeOptions options = dynamic_options();
  options.kind = ComplianceKind::static_equilibrium;
  return options;
}

ComplianceVariant computed(const TetMesh& mesh, const Material& material, const FixedSet* fixed,
                           const CompliancePrecomputeOptions& options,
                           const CompliancePrecomputeSettings& settings = {}) {
  auto variant = precompute_compliance(level_of(mesh), nullptr, material, fixed, options, settings);
  EXPECT_TRUE(variant.ok()) << (variant.ok() ? "" : format_issue(variant.issue()));
  return variant.ok() ? std::move(*variant) : ComplianceVariant{};
}

// The whole matrix through the runtime's own reader of the representation.
Eigen::MatrixXd whole(const ComplianceVariant& variant) {
  const auto rest = open_variant(variant);
  if (!rest) {
    ADD_FAILURE() << format_issue(rest.issue());
    return {};
  }
  std::vector<Index> rows(variant.nodes.size());
  std::iota(rows.begin(), rows.end(), 0);
  const auto size = Eigen::Index(3 * rows.size());
  Eigen::MatrixXd c(size, size);
  (*rest)->gather(rows, {c.data(), std::size_t(c.size())});
  return c;
}

Eigen::MatrixXd expected(const TetMesh& mesh, const Material& material,
                         const ComplianceVariant& variant, const FixedSet* fixed) {
  const auto full =
      dense_compliance(mesh, material, variant.header.mass_factor, variant.header.stiffness_factor,
                       fixed ? fixed->nodes : std::vector<Index>{});
  std::vector<Eigen::Index> rows;
  for (const Index node : variant.nodes)
    for (int c = 0; c < 3; ++c) rows.push_back(3 * node + c);
  return full(rows, rows);
}

// D^-1/2 E D^-1/2, D the diagonal blocks of C.
Eigen::MatrixXd scaled_error(const Eigen::MatrixXd& c, const Eigen::MatrixXd& e) {
  Eigen::MatrixXd scaled = e;
  for (Eigen::Index i = 0; i < c.rows() / 3; ++i) {
    const Mat3 d = c.block<3, 3>(3 * i, 3 * i);
    const Mat3 root = Eigen::SelfAdjointEigenSolver<Mat3>(d).operatorInverseSqrt();
    scaled.middleRows<3>(3 * i) = root * scaled.middleRows<3>(3 * i).eval();
    scaled.middleCols<3>(3 * i) = scaled.middleCols<3>(3 * i).eval() * root;
  }
  return scaled;
}
double spectral_norm(const Eigen::MatrixXd& symmetric) {
  return symmetric.selfadjointView<Eigen::Lower>().eigenvalues().cwiseAbs().maxCoeff();
}
double worst_column(const Eigen::MatrixXd& c, const Eigen::MatrixXd& e) {
  return (e.colwise().norm().array() / c.colwise().norm().array()).maxCoeff();
}

double relative(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).norm() / b.norm();
}

TEST(Precompute, EqualsTheDenseInverseFreeClampedDynamicAndStatic) {
  const FixedSet left = left_of(block);
  const auto free = computed(block, soft, nullptr, dynamic_options());
  EXPECT_LT(relative(whole(free), expected(block, soft, free, nullptr)), 1e-11);
  EXPECT_DOUBLE_EQ(free.header.mass_factor, 1e4 + 10);
  EXPECT_DOUBLE_EQ(free.header.stiffness_factor, 2);
  const auto clamped = computed(block, soft, &left, dynamic_options());
  EXPECT_LT(relative(whole(clamped), expected(block, soft, clamped, &left)), 1e-11);
  const auto still = computed(block, soft, &left, static_options());
  EXPECT_LT(relative(whole(still), expected(block, soft, still, &left)), 1e-10);
  EXPECT_EQ(still.header.mass_factor, 0);
  EXPECT_EQ(still.header.time_step_s, 0);
  EXPECT_EQ(still.header.fixed_set, "left");
  for (const auto& variant : {free, clamped, still}) {
    EXPECT_LT(variant.header.error.solve_residual, 1e-10);
    EXPECT_EQ(variant.header.error.frobenius, 0) << "doubles are stored as they are";
  }
}

TEST(Precompute, HoldsTheSurfaceNodesThatCanMove) {
  const FixedSet left = left_of(block);
  const auto variant = computed(block, soft, &left, dynamic_options());
  std::vector<Index> nodes = used_nodes(boundary_triangles(block.tets));
  std::erase_if(nodes, [&](Index n) { return std::ranges::binary_search(left.nodes, n); });
  EXPECT_EQ(variant.nodes, nodes);
  EXPECT_EQ(variant.header.node_count, std::int64_t(nodes.size()));
}

TEST(Precompute, IsSymmetricPositiveDefiniteInBothScalarTypes) {
  for (const auto scalar : {ScalarType::float32, ScalarType::float64}) {
    const Eigen::MatrixXd c = whole(computed(block, soft, nullptr, dynamic_options(scalar)));
    EXPECT_EQ((c - c.transpose()).norm(), 0);
    EXPECT_GT(c.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0);
  }
}

TEST(Precompute, StoredErrorIsTheErrorOfTheStoredScalars) {
  const auto exact = computed(block, soft, nullptr, dynamic_options());
  const auto stored = computed(block, soft, nullptr, dynamic_options(ScalarType::float32));
  const Eigen::MatrixXd c = whole(exact), e = c - whole(stored);
  EXPECT_NEAR(stored.header.error.frobenius, e.norm() / c.norm(), 1e-12);
  EXPECT_NEAR(stored.header.error.worst_column,
              (e.colwise().norm().array() / c.colwise().norm().array()).maxCoeff(), 1e-12);
  const Eigen::MatrixXd scaled = scaled_error(c, e);
  const double spectral = spectral_norm(scaled);
  EXPECT_GE(stored.header.error.scaled_spectral, spectral) << "an upper bound";
  EXPECT_NEAR(stored.header.error.scaled_spectral, scaled.norm(), 1e-10);
  EXPECT_LT(stored.header.error.scaled_spectral, 1e-5);
}

TEST(Precompute, ScalesInverselyWithStiffnessAndSize) {  // 1.4
  const FixedSet left = left_of(block);
  const Eigen::MatrixXd c = whole(computed(block, soft, &left, static_options()));
  const Eigen::MatrixXd stiffer =
      whole(computed(block, material_of(3e4, 0.4, 1000), &left, static_options()));
  EXPECT_LT(relative(3 * stiffer, c), 1e-10);
  for (const double scale : {1e-3, 1e3}) {
    TetMesh scaled = block;
    for (Point& p : scaled.nodes)
      for (double& x : p) x *= scale;
    EXPECT_LT(relative(scale * whole(computed(scaled, soft, &left, static_options())), c), 1e-9);
  }
}

TEST(Precompute, MovesAndTurnsWithTheBody) {  // 1.4
  const FixedSet left = left_of(block);
  const Eigen::MatrixXd c = whole(computed(block, soft, &left, dynamic_options()));
  const Mat3 r = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  TetMesh turned = block;
  for (Point& p : turned.nodes) p = as_point(r * as_vec3(p) + Vec3(3, -2, 5));
  const Eigen::MatrixXd moved = whole(computed(turned, soft, &left, dynamic_options()));
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(c.rows(), c.cols());
  for (Eigen::Index i = 0; i < c.rows() / 3; ++i) turn.block<3, 3>(3 * i, 3 * i) = r;
  EXPECT_LT(relative(moved, turn * c * turn.transpose()), 1e-9);
}

TEST(Precompute, HalfTheWorkOfForcesIsTheElasticEnergy) {  // 1.4
  const FixedSet left = left_of(block);
  const auto variant = computed(block, soft, &left, static_options());
  const Eigen::MatrixXd full = dense_compliance(block, soft, 0, 1, left.nodes);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(full.rows()),
                  surface(3 * Eigen::Index(variant.nodes.size()));
  for (Eigen::Index k = 0; k < surface.size(); ++k) {
    surface[k] = 1e-5 * std::sin(double(k));
    f[3 * variant.nodes[std::size_t(k / 3)] + k % 3] = surface[k];
  }
  const Eigen::VectorXd u = full * f;
  const auto model = CorotationalModel::create(block, soft);
  ASSERT_TRUE(model.ok());
  Eigen::VectorXd x(u.size());
  for (std::size_t n = 0; n < block.nodes.size(); ++n)
    x.segment<3>(3 * Eigen::Index(n)) = as_vec3(block.nodes[n]) + u.segment<3>(3 * Eigen::Index(n));
  const std::vector<Mat3> upright(block.tets.size(), Mat3::Identity());
  const double work = 0.5 * surface.dot(whole(variant) * surface);
  EXPECT_GT(work, 0);
  EXPECT_NEAR(model->elastic_energy(x, upright), work, 1e-8 * work);
}

TEST(Precompute, AddedSupportsNeverSoften) {  // 1.4
  const FixedSet few = left_of(block), more = left_of(block, 0.05);
  ASSERT_GT(more.nodes.size(), few.nodes.size());
  const auto loose = computed(block, soft, &few, static_options());
  const auto held = computed(block, soft, &more, static_options());
  const Eigen::MatrixXd c_loose = whole(loose), c_held = whole(held);
  std::vector<Eigen::Index> shared;
  for (std::size_t k = 0; k < loose.nodes.size(); ++k)
    if (std::ranges::binary_search(held.nodes, loose.nodes[k]))
      for (int c = 0; c < 3; ++c) shared.push_back(Eigen::Index(3 * k) + c);
  const Eigen::MatrixXd difference = c_loose(shared, shared) - c_held;
  EXPECT_GT(difference.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(),
            -1e-10 * c_loose.norm());
}

TEST(Precompute, StaticIsTheLimitOfDynamicForLongSteps) {
  const FixedSet left = left_of(block);
  const Material undamped = material_of(1e4, 0.4, 1000);
  const Eigen::MatrixXd still = whole(computed(block, undamped, &left, static_options()));
  double last = INFINITY;
  for (const double h : {0.1, 1.0, 10.0}) {
    auto options = dynamic_options();
    options.time_step_s = h;
    const double error = relative(whole(computed(block, undamped, &left, options)), still);
    EXPECT_LT(error, 0.02 * last);
    last = error;
  }
  EXPECT_LT(last, 1e-4);
}

TEST(Precompute, GivesTheSameBytesEveryTime) {
  const auto options = dynamic_options(ScalarType::float32);
  const auto first = computed(block, soft, nullptr, options),
             second = computed(block, soft, nullptr, options);
  EXPECT_EQ(first.payload, second.payload);
  EXPECT_EQ(first.header.error.solve_residual, second.header.error.solve_residual);
}

TEST(Precompute, HoldsTheTouchedNodesOfTheSurfaceOnly) {
  auto options = dynamic_options();
  const auto all = computed(block, soft, nullptr, options);
  for (std::size_t n = 0; n < block.nodes.size(); ++n)
    if (block.nodes[n][0] < 0.09) options.nodes.push_back(Index(n));
  const auto some = computed(block, soft, nullptr, options);
  std::vector<Index> nodes;
  std::vector<Eigen::Index> rows;
  for (std::size_t k = 0; k < all.nodes.size(); ++k) {
    if (!std::ranges::binary_search(options.nodes, all.nodes[k])) continue;
    nodes.push_back(all.nodes[k]);
    for (int c = 0; c < 3; ++c) rows.push_back(Eigen::Index(3 * k) + c);
  }
  ASSERT_EQ(some.nodes, nodes);
  ASSERT_LT(nodes.size(), all.nodes.size());
  EXPECT_LT(relative(whole(some), whole(all)(rows, rows)), 1e-13);
}

TEST(Precompute, SingleNodesAreSmallCompliancesToo) {
  const Eigen::MatrixXd c = whole(computed(block, soft, nullptr, dynamic_options()));
  for (const double tolerance : {0.0, 1e-3}) {
    auto options = dynamic_options();
    options.tolerance = tolerance;
    options.nodes = {0};
    const auto one = computed(block, soft, nullptr, options);
    EXPECT_EQ(one.nodes, options.nodes);
    EXPECT_LT(relative(whole(one), c.topLeftCorner(3, 3)), std::max(1e-12, tolerance));
  }
}

TEST(Precompute, KeepsToItsToleranceInTheNormAskedForDenselyAndBySolves) {
  const Eigen::MatrixXd c = whole(computed(block, soft, nullptr, dynamic_options()));
  for (const auto way : {ComplianceWay::dense, ComplianceWay::by_solves})
    for (const auto norm : {ErrorNorm::scaled_spectral, ErrorNorm::frobenius, ErrorNorm::worst_column})
      for (const double tolerance : {1e-2, 1e-3, 1e-5}) {
        auto options = dynamic_options();
        options.tolerance = tolerance;
        options.norm = norm;
        CompliancePrecomputeSettings settings;
        settings.way = way;
        SCOPED_TRACE(testing::Message() << int(way) << " norm " << int(norm) << " " << tolerance);
        const auto stored = computed(block, soft, nullptr, options, settings);
        ASSERT_EQ(stored.header.representation, ComplianceRepresentation::hierarchical);
        const Eigen::MatrixXd decoded = whole(stored), e = c - decoded;
        const double error = norm == ErrorNorm::frobenius      ? e.norm() / c.norm()
                             : norm == ErrorNorm::worst_column ? worst_column(c, e)
                                                               : spectral_norm(scaled_error(c, e));
        EXPECT_LE(error, tolerance);
        EXPECT_EQ(stored.header.tolerance_asked, tolerance);
        EXPECT_EQ(stored.header.error_norm, norm);
        EXPECT_LE(stored.header.error.solve_residual, std::max(1e-6, tolerance / 16));
        EXPECT_GT(decoded.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0);
      }
}

TEST(Precompute, OffersTheSolvesWhereTheDenseFormDoesNotFit) {
  const TetMesh mesh = irregular_box_mesh({14, 13, 3}, {0, 0, 0}, {0.2, 0.2, 0.05}, 0.5);
  auto options = dynamic_options();
  options.tolerance = 1e-2;
  CompliancePrecomputeSettings settings;
  settings.memory_limit_bytes = 5 * 3 * 3 * used_nodes(boundary_triangles(mesh.tets)).size() *
                                used_nodes(boundary_triangles(mesh.tets)).size() / 10;
  const auto level = level_of(mesh);
  settings.way = ComplianceWay::dense;
  const auto refused = precompute_compliance(level, nullptr, soft, nullptr, options, settings);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.issue().code, IssueCode::compliance_out_of_memory);
  EXPECT_NE(format_issue(refused.issue()).find("by-solves"), std::string::npos);
}

TEST(Precompute, BytesDoNotDependOnTheThreads) {
  for (const double tolerance : {0.0, 1e-3}) {
    auto options = dynamic_options(ScalarType::float32);
    options.tolerance = tolerance;
    CompliancePrecomputeSettings settings;
    settings.threads = 1;
    const auto first = computed(block, soft, nullptr, options, settings);
    for (const unsigned threads : {2U, 3U}) {
      settings.threads = threads;
      const auto other = computed(block, soft, nullptr, options, settings);
      EXPECT_EQ(first.payload, other.payload);
      EXPECT_EQ(first.header.error.solve_residual, other.header.error.solve_residual);
      EXPECT_EQ(first.header.error.scaled_spectral, other.header.error.scaled_spectral);
    }
  }
}

/// Every node of `mesh` in the tet of `coarse` that it lies in.
std::vector<Embedding> embedded_in(const TetMesh& mesh, const TetMesh& coarse) {
  std::vector<Embedding> embedding;
  for (const Point& p : mesh.nodes) {
    Embedding best;
    double least = -INFINITY;
    for (std::size_t t = 0; t < coarse.tets.size(); ++t) {
      const Vec3 first = as_vec3(coarse.nodes[std::size_t(coarse.tets[t][0])]);
      Mat3 edges;
      for (int k = 0; k < 3; ++k)
        edges.col(k) = as_vec3(coarse.nodes[std::size_t(coarse.tets[t][std::size_t(k) + 1])]) - first;
      const Vec3 w = edges.inverse() * (as_vec3(p) - first);
      const double inside = std::min(w.minCoeff(), 1 - w.sum());
      if (inside <= least) continue;
      least = inside;
      best = {Index(t), {1 - w.sum(), w[0], w[1], w[2]}};
    }
    embedding.push_back(best);
  }
  return embedding;
}

TEST(Precompute, CarriesTheCoarseComplianceUpAndMeasuresItAgainstTheFineOne) {
  const MeshLevel coarse = level_of(box_mesh({3, 2, 2}, {0, 0, 0}, {0.2, 0.12, 0.12}));
  MeshLevel fine = level_of(box_mesh({6, 4, 4}, {0, 0, 0}, {0.2, 0.12, 0.12}));
  fine.embedding = embedded_in(fine.mesh, coarse.mesh);
  const FixedSet left = left_of(fine.mesh);
  for (const FixedSet* fixed : {static_cast<const FixedSet*>(nullptr), &left})
    for (const double tolerance : {0.0, 1e-3}) {
      auto options = dynamic_options(ScalarType::float32);
      const auto exact = precompute_compliance(fine, nullptr, soft, fixed, dynamic_options(), {});
      options.coarsening = 1;
      options.tolerance = tolerance;
      const auto stored = precompute_compliance(fine, &coarse, soft, fixed, options, {});
      ASSERT_TRUE(exact.ok() && stored.ok()) << (stored ? "" : format_issue(stored.issue()));
      EXPECT_EQ(stored->nodes, exact->nodes);
      EXPECT_EQ(stored->prolongation.size(), stored->nodes.size());
      EXPECT_LT(stored->header.node_count, std::int64_t(stored->nodes.size()) / 2);
      const Eigen::MatrixXd c = whole(*exact), up = whole(*stored), e = c - up;
      const ComplianceError& error = stored->header.error;
      EXPECT_NEAR(error.frobenius, e.norm() / c.norm(), 1e-4 * error.frobenius);
      EXPECT_NEAR(error.worst_column, worst_column(c, e), 1e-4 * error.worst_column);
      const double spectral = spectral_norm(scaled_error(c, e));
      EXPECT_NEAR(error.scaled_spectral, spectral, 0.01 * spectral);
      // Galerkin: the coarse body is stiffer for every force, up to what storing added.
      const auto least = e.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff();
      EXPECT_GT(least, -(tolerance + 1e-6) * c.norm());
    }
}

TEST(Precompute, CoarseAndFineRigidBodiesMoveAlike) {
  const MeshLevel coarse = level_of(box_mesh({3, 2, 2}, {0, 0, 0}, {0.2, 0.12, 0.12}));
  MeshLevel fine = level_of(box_mesh({6, 4, 4}, {0, 0, 0}, {0.2, 0.12, 0.12}));
  fine.embedding = embedded_in(fine.mesh, coarse.mesh);
  auto options = dynamic_options();
  options.coarsening = 1;
  const Material rigid = material_of(1e11, 0.3, 1000);
  const auto stored = precompute_compliance(fine, &coarse, rigid, nullptr, options, {});
  const auto exact = precompute_compliance(fine, nullptr, rigid, nullptr, dynamic_options(), {});
  ASSERT_TRUE(stored.ok() && exact.ok());
  // So stiff that a step only moves it as a whole.
  EXPECT_LT(relative(whole(*stored), whole(*exact)), 1e-4);
}

/// Residual met, or refused with a code and the worst element.
void expect_met_or_refused(const TetMesh& mesh, const Material& material, const FixedSet* fixed,
                           CompliancePrecomputeOptions options, bool must_meet) {
  for (const double tolerance : {0.0, 1e-3}) {
    options.tolerance = tolerance;
    const auto variant = precompute_compliance(level_of(mesh), nullptr, material, fixed, options, {});
    if (variant) {
      EXPECT_LE(variant->header.error.solve_residual, tolerance > 0 ? tolerance / 16 : 1e-6);
      EXPECT_TRUE(whole(*variant).allFinite());
      continue;
    }
    EXPECT_FALSE(must_meet) << format_issue(variant.issue());
    EXPECT_TRUE(variant.issue().code == IssueCode::compliance_residual_too_large ||
                variant.issue().code == IssueCode::compliance_factorisation_failed)
        << format_issue(variant.issue());
    EXPECT_NE(variant.issue().where.find("tet "), std::string::npos);
  }
}

TEST(Precompute, NearlyIncompressibleBodiesMeetTheResidual) {
  const FixedSet left = left_of(block);
  for (const double poisson : {0.49, 0.499, 0.4999}) {
    expect_met_or_refused(block, material_of(1e4, poisson, 1000), nullptr, dynamic_options(), true);
    expect_met_or_refused(block, material_of(1e4, poisson, 1000), &left, static_options(), true);
  }
}

TEST(Precompute, StiffnessContrastMeetsTheResidual) {
  const FixedSet left = left_of(block);
  Material two = soft;
  two.regions.push_back({"hard", 1e10, 0.3, 2000});
  for (const Tet& tet : block.tets) {
    double x = 0;
    for (const Index n : tet) x += block.nodes[std::size_t(n)][0] / 4;
    two.tet_region.push_back(x < 0.1 ? 0 : 1);
  }
  expect_met_or_refused(block, two, nullptr, dynamic_options(), true);
  expect_met_or_refused(block, two, &left, static_options(), true);
}

// A step moves a tiny body as a whole, by 1e11 times what strains it: the mass that resists it is lost
// in the rounding of the stiffness, and the last digits of C with it.
TEST(Precompute, TinyAndHugeBodiesMeetTheResidual) {
  for (const double size : {1e-6, 1e-3, 1e3}) {
    TetMesh scaled = block;
    for (Point& p : scaled.nodes)
      for (double& x : p) x *= size / 0.2;
    const FixedSet left = left_of(scaled, 1e-9 * size);
    expect_met_or_refused(scaled, soft, nullptr, dynamic_options(), size > 1e-6);
    expect_met_or_refused(scaled, soft, &left, dynamic_options(), true);
    expect_met_or_refused(scaled, soft, &left, static_options(), true);
  }
}

TEST(Precompute, SliverRichMeshesMeetTheResidualOrNameTheWorst) {
  for (const double amount : {1.5, 2.0, 2.2}) {  // some tets all but flat, or inverted
    const TetMesh mesh = irregular_box_mesh({5, 5, 5}, {0, 0, 0}, {0.2, 0.2, 0.2}, amount);
    const auto exact =
        precompute_compliance(level_of(mesh), nullptr, soft, nullptr, dynamic_options(), {});
    if (!exact && exact.issue().code == IssueCode::mesh_element_invalid) continue;
    const FixedSet left = left_of(mesh);
    expect_met_or_refused(mesh, soft, nullptr, dynamic_options(), false);
    expect_met_or_refused(mesh, soft, &left, static_options(), false);
  }
}

TEST(Precompute, ReportsProgressThatNeverFallsBack) {
  for (const double tolerance : {0.0, 1e-3, 1e-5, 1e-6}) {
    auto options = dynamic_options();
    options.tolerance = tolerance;
    CompliancePrecomputeSettings settings;
    double last = 0;
    settings.progress = [&](double fraction) {
      EXPECT_GE(fraction, last);
      EXPECT_LE(fraction, 1);
      last = fraction;
    };
    computed(block, soft, nullptr, options, settings);
    EXPECT_GT(last, 0);
  }
}

}  // namespace
}  // namespace souple
