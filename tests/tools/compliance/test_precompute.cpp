// SPDX-License-Identifier: GPL-3.0-or-later
// References 1.4, against a dense inverse that was assembled another way.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numeric>

#include "runtime/compliance/rest_compliance.hpp"
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

CompliancePrecomputeOptions dynamic_options(ScalarType scalar = ScalarType::float64) {
  CompliancePrecomputeOptions options;
  options.scalar = scalar;
  return options;
}

CompliancePrecomputeOptions static_options() {
  CompliancePrecomputeOptions options = dynamic_options();
  options.kind = ComplianceKind::static_equilibrium;
  return options;
}

ComplianceVariant computed(const TetMesh& mesh, const Material& material, const FixedSet* fixed,
                           const CompliancePrecomputeOptions& options) {
  auto variant = precompute_compliance(level_of(mesh), material, fixed, options);
  EXPECT_TRUE(variant.ok()) << (variant.ok() ? "" : format_issue(variant.issue()));
  return variant.ok() ? std::move(*variant) : ComplianceVariant{};
}

// The whole matrix through the runtime's own reader of the representation.
Eigen::MatrixXd whole(const ComplianceVariant& variant) {
  const std::size_t scalar = variant.header.scalar == ScalarType::float32 ? 4 : 8;
  auto rest = open_rest_compliance(
      variant.header, std::make_unique<MemoryBlockSource>(
                          variant.payload, std::size_t(variant.header.block_scalars) * scalar));
  EXPECT_TRUE(rest.ok());
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
  Eigen::MatrixXd scaled = e;
  for (Eigen::Index i = 0; i < c.rows() / 3; ++i) {
    const Mat3 d = c.block<3, 3>(3 * i, 3 * i);
    const Mat3 root = Eigen::SelfAdjointEigenSolver<Mat3>(d).operatorInverseSqrt();
    scaled.middleRows<3>(3 * i) = root * scaled.middleRows<3>(3 * i).eval();
    scaled.middleCols<3>(3 * i) = scaled.middleCols<3>(3 * i).eval() * root;
  }
  const double spectral = scaled.selfadjointView<Eigen::Lower>().eigenvalues().cwiseAbs().maxCoeff();
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

TEST(Precompute, ReportsProgressThatNeverFallsBack) {
  auto options = dynamic_options();
  double last = 0;
  options.progress = [&](double fraction) {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1);
    last = fraction;
  };
  computed(block, soft, nullptr, options);
  EXPECT_GT(last, 0);
}

}  // namespace
}  // namespace souple
