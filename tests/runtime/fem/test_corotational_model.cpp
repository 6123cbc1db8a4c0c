// SPDX-License-Identifier: MIT
// References 1.1-1.3 of the closed forms, and what must not change under rigid motion.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "runtime/fem/corotational_model.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"

namespace souple {
namespace {

using test::box_mesh;
using test::irregular_box_mesh;
using test::material_of;

CorotationalModel model_of(const TetMesh& mesh, const Material& material) {
  auto model = CorotationalModel::create(mesh, material);
  EXPECT_TRUE(model.ok());
  return std::move(*model);
}

Eigen::VectorXd positions(const TetMesh& mesh, const Mat3& map = Mat3::Identity(),
                          const Vec3& shift = Vec3::Zero()) {
  Eigen::VectorXd x(3 * Eigen::Index(mesh.nodes.size()));
  for (std::size_t k = 0; k < mesh.nodes.size(); ++k)
    x.segment<3>(3 * Eigen::Index(k)) = map * as_vec3(mesh.nodes[k]) + shift;
  return x;
}

Eigen::MatrixXd dense(const BlockMatrix& a) {
  const Index n = a.pattern->node_count();
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (Index row = 0; row < n; ++row)
    for (Index b = a.pattern->row_begin[row]; b < a.pattern->row_begin[row + 1]; ++b)
      full.block<3, 3>(3 * row, 3 * a.pattern->column[b]) = a.block(b);
  return full;
}

Eigen::VectorXd elastic_forces(const CorotationalModel& model, const Eigen::VectorXd& x) {
  std::vector<Mat3> rotations;
  model.element_rotations(x, rotations);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(x.size());
  model.add_elastic_forces(x, rotations, f);
  return f;
}

Mat3 random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

TEST(CorotationalModel, SingleTetHasTheClosedFormStiffness) {  // 1.1
  TetMesh tet;
  tet.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tet.tets = {{0, 1, 2, 3}};
  const auto model = model_of(tet, material_of(1, 0.25, 1));
  BlockMatrix k(model.pattern());
  model.assemble_rest(0, 1, k);
  const Eigen::MatrixXd stiffness = dense(k);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(stiffness(i, j), i == j ? 1.0 / 3 : 2.0 / 15, 1e-15);
  EXPECT_LT((stiffness - stiffness.transpose()).norm(), 1e-16);
  const Eigen::VectorXd eigenvalues = stiffness.selfadjointView<Eigen::Lower>().eigenvalues();
  EXPECT_LT(eigenvalues.head(6).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_GT(eigenvalues[6], 1e-2);
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd translation = Eigen::VectorXd::Zero(12), rotation = translation;
    for (int node = 0; node < 4; ++node) {
      translation[3 * node + axis] = 1;
      rotation.segment<3>(3 * node) = Vec3::Unit(axis).cross(as_vec3(tet.nodes[std::size_t(node)]));
    }
    EXPECT_LT((stiffness * translation).norm(), 1e-15);
    EXPECT_LT((stiffness * rotation).norm(), 1e-15);
  }
}

TEST(CorotationalModel, AssembledStiffnessEqualsTheSumOfBTransposeDB) {
  const TetMesh mesh = irregular_box_mesh({3, 2, 2}, {0.1, 0.2, 0.3}, {0.3, 0.2, 0.2}, 0.9);
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  std::mt19937 random(1);
  const Mat3 r = random_rotation(random);
  BlockMatrix k(model.pattern());
  model.assemble(0, 1, std::vector<Mat3>(mesh.tets.size(), r), k);
  const Eigen::MatrixXd expected = test::dense_stiffness(mesh, 1e4, 0.4, r);
  EXPECT_LT((dense(k) - expected).norm() / expected.norm(), 1e-13);
}

TEST(CorotationalModel, PatchTestReproducesALinearFieldOnAnIrregularMesh) {  // 1.2
  const TetMesh mesh = irregular_box_mesh({4, 4, 4}, {0, 0, 0}, {1, 1, 1}, 1.0);
  const auto model = model_of(mesh, material_of(1e6, 0.25, 1));
  BlockMatrix k(model.pattern());
  model.assemble_rest(0, 1, k);
  Mat3 gradient;
  gradient << 2, 1, 1, 1, 2, 1, 1, 1, 2;
  gradient *= 0.5e-3;
  const Eigen::VectorXd exact = positions(mesh, gradient);
  std::vector<Eigen::Index> inner, outer;
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node) {
    bool boundary = false;
    for (const double c : mesh.nodes[node]) boundary |= c < 1e-9 || c > 1 - 1e-9;
    for (int c = 0; c < 3; ++c) (boundary ? outer : inner).push_back(Eigen::Index(3 * node) + c);
  }
  ASSERT_GT(inner.size(), 60u);
  const Eigen::MatrixXd full = dense(k);
  const Eigen::MatrixXd own = full(inner, inner), coupling = full(inner, outer);
  const Eigen::VectorXd given = exact(outer), expected = exact(inner);
  const Eigen::VectorXd solution = own.llt().solve(-coupling * given);
  EXPECT_LT((solution - expected).norm() / exact.norm(), 1e-12);
  // Stress from the energy density: strain eps_ii = gamma_ij = 1e-3, sigma_ii = 2000, tau_ij = 400.
  const double energy = 0.5 * exact.dot(full * exact);
  EXPECT_NEAR(energy, 0.5 * (3 * 2000 * 1e-3 + 3 * 400 * 1e-3), 1e-9);
}

TEST(CorotationalModel, UniaxialTractionGivesTheClosedFormElongation) {  // 1.3
  const TetMesh mesh = box_mesh({10, 2, 2}, {0, 0, 0}, {10, 1, 1});
  const double young = 1e7, poisson = 0.3, force = 1;
  const auto model = model_of(mesh, material_of(young, poisson, 1));
  BlockMatrix k(model.pattern());
  model.assemble_rest(0, 1, k);
  // Statically determinate supports: u_x = 0 on x = 0, and just enough more to stop rigid motion.
  std::vector<char> held(3 * mesh.nodes.size(), 0);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(Eigen::Index(held.size()));
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Point& p = mesh.nodes[n];
    if (p[0] == 0) held[3 * n] = 1;
    if (p[0] == 0 && p[1] == 0 && p[2] == 0) held[3 * n + 1] = held[3 * n + 2] = 1;
    if (p[0] == 0 && p[1] == 1 && p[2] == 0) held[3 * n + 2] = 1;
  }
  for (const Triangle& t : boundary_triangles(mesh.tets)) {
    const Vec3 a = as_vec3(mesh.nodes[t[0]]), b = as_vec3(mesh.nodes[t[1]]),
               c = as_vec3(mesh.nodes[t[2]]);
    if (a.x() < 10 - 1e-9 || b.x() < 10 - 1e-9 || c.x() < 10 - 1e-9) continue;
    for (const Index node : t) load[3 * node] += force * 0.5 * (b - a).cross(c - a).norm() / 3;
  }
  EXPECT_NEAR(load.sum(), force, 1e-12);
  std::vector<Eigen::Index> free;
  for (std::size_t i = 0; i < held.size(); ++i)
    if (!held[i]) free.push_back(Eigen::Index(i));
  Eigen::VectorXd u = Eigen::VectorXd::Zero(load.size());
  const Eigen::MatrixXd full = dense(k);
  const Eigen::MatrixXd part = full(free, free);
  const Eigen::VectorXd free_load = load(free);
  const Eigen::VectorXd solved = part.llt().solve(free_load);
  u(free) = solved;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    EXPECT_NEAR(u[3 * n], 1e-6 * mesh.nodes[n][0] / 10, 1e-15);
    EXPECT_NEAR(u[3 * n + 1], -poisson * force / young * mesh.nodes[n][1], 1e-15);
    EXPECT_NEAR(u[3 * n + 2], -poisson * force / young * mesh.nodes[n][2], 1e-15);
  }
}

TEST(CorotationalModel, HydrostaticPressureGivesTheClosedFormVolumeChange) {  // 1.3
  const TetMesh mesh = irregular_box_mesh({3, 3, 3}, {0, 0, 0}, {1, 1, 1}, 1.0);
  const double young = 1e6, poisson = 0.3, pressure = 10;
  const auto model = model_of(mesh, material_of(young, poisson, 1));
  // A uniform contraction by p (1 - 2 nu) / E must balance the pressure on every boundary node.
  const double strain = pressure * (1 - 2 * poisson) / young;
  const Eigen::VectorXd f = elastic_forces(model, positions(mesh, (1 - strain) * Mat3::Identity()));
  Eigen::VectorXd balance = f;
  for (const Triangle& t : boundary_triangles(mesh.tets)) {
    const Vec3 a = as_vec3(mesh.nodes[t[0]]), b = as_vec3(mesh.nodes[t[1]]),
               c = as_vec3(mesh.nodes[t[2]]);
    for (const Index node : t) balance.segment<3>(3 * node) -= pressure * (b - a).cross(c - a) / 6;
  }
  EXPECT_LT(balance.norm() / f.norm(), 1e-9);
}

TEST(CorotationalModel, RigidMotionMakesNoForceAtAnyRotation) {
  const TetMesh mesh = irregular_box_mesh({3, 3, 2}, {0, 0, 0}, {0.2, 0.2, 0.1}, 1.0);
  const auto model = model_of(mesh, material_of(1e4, 0.45, 1000));
  std::mt19937 random(5);
  for (int k = 0; k < 1000; ++k) {
    const Eigen::VectorXd x = positions(mesh, random_rotation(random), Vec3(0.3, -0.2, 0.5));
    // Scale: E times an area of the mesh.
    EXPECT_LT(elastic_forces(model, x).lpNorm<Eigen::Infinity>(), 1e-12 * 1e4 * 0.04);
  }
}

TEST(CorotationalModel, ForcesAndEnergyTurnWithTheBody) {
  const TetMesh mesh = irregular_box_mesh({2, 2, 2}, {0, 0, 0}, {0.2, 0.2, 0.2}, 1.0);
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  std::mt19937 random(6);
  Eigen::VectorXd x = positions(mesh);
  x += 0.02 * Eigen::VectorXd::Random(x.size());
  std::vector<Mat3> rotations;
  model.element_rotations(x, rotations);
  const double energy = model.elastic_energy(x, rotations);
  const Eigen::VectorXd f = elastic_forces(model, x);
  EXPECT_GT(energy, 0);
  for (int k = 0; k < 50; ++k) {
    const Mat3 r = random_rotation(random);
    Eigen::VectorXd turned(x.size()), expected(x.size());
    for (Eigen::Index n = 0; n < x.size() / 3; ++n) {
      turned.segment<3>(3 * n) = r * x.segment<3>(3 * n) + Vec3(1, 2, 3);
      expected.segment<3>(3 * n) = r * f.segment<3>(3 * n);
    }
    EXPECT_LT((elastic_forces(model, turned) - expected).norm() / f.norm(), 1e-11);
    model.element_rotations(turned, rotations);
    EXPECT_NEAR(model.elastic_energy(turned, rotations), energy, 1e-11 * energy);
  }
}

TEST(CorotationalModel, ForcesOfAnyShapeSumToZeroWithoutMoment) {
  const TetMesh mesh = irregular_box_mesh({3, 2, 2}, {0, 0, 0}, {0.2, 0.2, 0.2}, 1.0);
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  Eigen::VectorXd x = positions(mesh);
  x += 0.03 * Eigen::VectorXd::Random(x.size());  // some elements are inverted by this
  const Eigen::VectorXd f = elastic_forces(model, x);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  for (Eigen::Index n = 0; n < x.size() / 3; ++n) {
    sum += f.segment<3>(3 * n);
    moment += x.segment<3>(3 * n).cross(f.segment<3>(3 * n));
  }
  EXPECT_LT(sum.norm() / f.norm(), 1e-13);
  // The polar rotation makes R^T F symmetric, so that the element forces carry no moment.
  EXPECT_LT(moment.norm() / (f.norm() * 0.2), 1e-11);
}

TEST(CorotationalModel, ForceIsMinusTheGradientOfTheEnergyForSmallStrains) {
  const TetMesh mesh = irregular_box_mesh({2, 2, 2}, {0, 0, 0}, {0.2, 0.2, 0.2}, 1.0);
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  Eigen::VectorXd x = positions(mesh);
  x += 1e-3 * Eigen::VectorXd::Random(x.size());
  const Eigen::VectorXd f = elastic_forces(model, x);
  std::vector<Mat3> rotations;
  const auto energy = [&](const Eigen::VectorXd& at) {
    model.element_rotations(at, rotations);
    return model.elastic_energy(at, rotations);
  };
  Eigen::VectorXd gradient(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Eigen::VectorXd ahead = x, behind = x;
    ahead[i] += 1e-6;
    behind[i] -= 1e-6;
    gradient[i] = (energy(ahead) - energy(behind)) / 2e-6;
  }
  EXPECT_LT((f + gradient).norm() / f.norm(), 1e-6);
}

TEST(CorotationalModel, NodeRotationsOfARigidlyTurnedBodyAreItsRotation) {
  const TetMesh mesh = box_mesh({2, 2, 2}, {0, 0, 0}, {1, 1, 1});
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  std::mt19937 random(8);
  const Mat3 r = random_rotation(random);
  std::vector<Mat3> elements, nodes;
  model.element_rotations(positions(mesh, r), elements);
  model.node_rotations(elements, nodes);
  for (const Mat3& node : nodes) EXPECT_LT((node - r).norm(), 1e-13);
}

TEST(CorotationalModel, RefusesInvertedFlatAndForeignElementsAndBadMaterial) {
  const auto code_of = [](const TetMesh& mesh, const Material& material) {
    const auto model = CorotationalModel::create(mesh, material);
    return model ? IssueCode{} : model.issue().code;
  };
  const Material good = material_of(1e4, 0.4, 1000);
  const TetMesh mesh = box_mesh({1, 1, 1}, {0, 0, 0}, {1, 1, 1});
  TetMesh inverted = mesh, flat = mesh, foreign = mesh, infinite = mesh, unused = mesh;
  std::swap(inverted.tets[2][0], inverted.tets[2][1]);
  flat.tets[1][3] = flat.tets[1][2];
  foreign.tets[0][0] = 99;
  infinite.nodes[3][1] = INFINITY;
  unused.nodes.push_back({5, 5, 5});
  for (const auto& bad : {inverted, flat, foreign, infinite, unused, TetMesh{}})
    EXPECT_EQ(code_of(bad, good), IssueCode::mesh_element_invalid);
  for (const auto& bad : {material_of(0, 0.4, 1), material_of(-1, 0.4, 1), material_of(NAN, 0.4, 1),
                          material_of(1, 0.5, 1), material_of(1, -1, 1), material_of(1, NAN, 1),
                          material_of(1, 0.3, 0), material_of(1, 0.3, INFINITY),
                          material_of(1, 0.3, 1, -1), material_of(1, 0.3, 1, 0, NAN), Material{}})
    EXPECT_EQ(code_of(mesh, bad), IssueCode::material_out_of_range);
}

}  // namespace
}  // namespace souple
