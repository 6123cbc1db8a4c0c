// SPDX-License-Identifier: MIT
// The kernels in lanes against the slow way, for healthy, flat, inverted, huge and tiny elements.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "runtime/fem/corotational_model.hpp"
#include "tests/runtime/fem/naive_elements.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"

namespace souple {
namespace {

using test::irregular_box_mesh;
using test::material_of;
using test::NaiveElements;

CorotationalModel model_of(const TetMesh& mesh, const Material& material) {
  auto model = CorotationalModel::create(mesh, material);
  EXPECT_TRUE(model.ok());
  return std::move(*model);
}

TetMesh small_mesh() { return irregular_box_mesh({4, 3, 2}, {0.1, 0, 0}, {0.2, 0.15, 0.1}, 0.8); }

Mat3 random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

/// Every node mapped, and moved by normal noise.
Eigen::VectorXd shape_of(const TetMesh& mesh, const Mat3& map, double noise = 0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  Eigen::VectorXd x(3 * Eigen::Index(mesh.nodes.size()));
  for (std::size_t k = 0; k < mesh.nodes.size(); ++k) {
    const Vec3 shift(normal(random), normal(random), normal(random));
    x.segment<3>(3 * Eigen::Index(k)) = map * as_vec3(mesh.nodes[k]) + noise * shift;
  }
  return x;
}

/// Two stiffnesses, a million apart, of different Poisson's ratios, in stripes.
Material striped(const TetMesh& mesh) {
  Material material = material_of(1e4, 0.4, 1000);
  material.regions.push_back({"hard", 1e10, 0.2, 2000});
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) material.tet_region.push_back(t / 7 % 2 == 1);
  return material;
}

void expect_rotation(const Mat3& r) {
  EXPECT_LT((r.transpose() * r - Mat3::Identity()).norm(), 1e-11);
  EXPECT_GT(r.determinant(), 0.5);
}

/// tr(R^T F) cannot be larger for any rotation than for the polar one, unique or not.
void expect_nearest(const Mat3& r, const Mat3& f) {
  expect_rotation(r);
  const double largest = polar_rotation(f).cwiseProduct(f).sum();
  EXPECT_NEAR(r.cwiseProduct(f).sum(), largest, 1e-12 * f.norm());
}

/// Second least singular value, less the least if det F < 0: 0 where the rotation is not unique.
double uniqueness(const Mat3& f) {
  const Eigen::JacobiSVD<Mat3> svd(f);
  const double sign = f.determinant() < 0 ? -1 : 1;
  return (svd.singularValues()[1] + sign * svd.singularValues()[2]) / svd.singularValues()[0];
}

TEST(ElementRotations, AreThePolarRotationsOfHealthyAndInvertedElements) {
  const TetMesh mesh = small_mesh();
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  const NaiveElements naive(mesh, material_of(1e4, 0.4, 1000));
  std::mt19937 random(2);
  int inverted = 0, clear = 0;
  for (const double noise : {0.0, 1e-6, 1e-3, 0.01, 0.03, 0.1})
    for (unsigned seed = 0; seed < 5; ++seed) {
      const Eigen::VectorXd x = shape_of(mesh, random_rotation(random), noise, seed);
      std::vector<Mat3> rotations;
      model.element_rotations(x, rotations);
      ASSERT_EQ(rotations.size(), mesh.tets.size());
      for (std::size_t t = 0; t < rotations.size(); ++t) {
        const Mat3 f = naive.gradient(t, x);
        expect_nearest(rotations[t], f);
        inverted += f.determinant() < 0;
        if (uniqueness(f) < 1e-3) continue;
        ++clear;
        EXPECT_LT((rotations[t] - polar_rotation(f)).norm(), 1e-11) << f;
      }
    }
  EXPECT_GT(inverted, 300);
  EXPECT_GT(clear, 3000);
}

TEST(ElementRotations, SurviveCollapseToAPlaneALineAndAPoint) {
  const TetMesh mesh = small_mesh();
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  const NaiveElements naive(mesh, material_of(1e4, 0.4, 1000));
  std::mt19937 random(3);
  const Vec3 stretches[] = {{1, 1, 0},         {1, 0.3, 0},    {1, 0, 0},      {0, 0, 0},
                            {1, 1, -1},        {-1, -1, -1},   {1, 1, 1e-9},   {1, 1e-9, 0},
                            {1, 1, -0.999999}, {2, 1, -1e-12}, {1e-9, 1e9, 1}, {1, 1e-5, 1e-5},
                            {1, 1e-5, -1e-5}};
  for (const Vec3& stretch : stretches) {
    const Mat3 map = random_rotation(random) * stretch.asDiagonal() * random_rotation(random);
    const Eigen::VectorXd x = shape_of(mesh, map);
    std::vector<Mat3> rotations;
    model.element_rotations(x, rotations);
    for (std::size_t t = 0; t < rotations.size(); ++t)
      expect_nearest(rotations[t], naive.gradient(t, x));
  }
}

TEST(ElementRotations, LoseNoMoreDigitsThanTheyMustNearAnInvertedCube) {
  // s2 + s3 = e and s1 + s3 = e: the rotation is determined to round-off over e.
  const TetMesh mesh = small_mesh();
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  const NaiveElements naive(mesh, material_of(1e4, 0.4, 1000));
  std::mt19937 random(13);
  for (const double e : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5}) {
    const Mat3 map = random_rotation(random) * Vec3(1, 1, e - 1).asDiagonal() * random_rotation(random);
    const Eigen::VectorXd x = shape_of(mesh, map);
    std::vector<Mat3> rotations;
    model.element_rotations(x, rotations);
    for (std::size_t t = 0; t < rotations.size(); ++t)
      EXPECT_LT((rotations[t] - polar_rotation(naive.gradient(t, x))).norm(), 1e-13 / e) << e;
  }
}

TEST(ElementRotations, DependOnNeitherTheSizeOfTheBodyNorThatOfTheDeformation) {
  const TetMesh unit = small_mesh();
  std::mt19937 random(4);
  const Eigen::VectorXd x = shape_of(unit, random_rotation(random), 0.02);
  std::vector<Mat3> expected, rotations;
  model_of(unit, material_of(1e4, 0.4, 1000)).element_rotations(x, expected);
  for (const double size : {1e-6, 1.0, 1e6}) {
    TetMesh mesh = unit;
    for (Point& p : mesh.nodes)
      for (double& coordinate : p) coordinate *= size;
    const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
    for (const double stretch : {1e-120, 1e-70, 1e-12, 1.0, 1e12, 1e70, 1e120}) {
      model.element_rotations(size * stretch * x, rotations);
      for (std::size_t t = 0; t < rotations.size(); ++t)
        EXPECT_LT((rotations[t] - expected[t]).norm(), 1e-10) << size << " " << stretch;
    }
  }
}

TEST(ElementRotations, AreTheSameBitsInAnyRangeAndPack) {
  const TetMesh mesh = small_mesh();
  const Eigen::VectorXd x = shape_of(mesh, Mat3::Identity(), 0.03);
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  std::vector<Mat3> all;
  model.element_rotations(x, all);
  std::vector<Mat3> parts(all.size());
  const IndexRange packs = model.elements().all_packs();
  for (Index begin = packs.begin; begin < packs.end; begin += 5)
    model.elements().evaluate(x.data(), RotationMethod::polar, {begin, std::min(begin + 5, packs.end)},
                              {parts.data()});
  EXPECT_EQ(all, parts);
  // The first elements alone, in a pack that is not full.
  for (std::size_t count = 1; count < 10; ++count) {
    TetMesh few = mesh;
    few.tets.resize(count);
    Index last = 0;
    for (const Tet& tet : few.tets) last = std::max(last, *std::ranges::max_element(tet));
    std::vector<Index> number(mesh.nodes.size(), -1);
    few.nodes.clear();
    std::vector<double> y;
    for (Tet& tet : few.tets)
      for (Index& node : tet) {
        Index& mine = number[std::size_t(node)];
        if (mine < 0) {
          mine = Index(few.nodes.size());
          few.nodes.push_back(mesh.nodes[std::size_t(node)]);
          y.insert(y.end(), x.data() + 3 * node, x.data() + 3 * node + 3);
        }
        node = mine;
      }
    std::vector<Mat3> rotations;
    model_of(few, material_of(1e4, 0.4, 1000))
        .element_rotations(Eigen::Map<const Eigen::VectorXd>(y.data(), Eigen::Index(y.size())),
                           rotations);
    ASSERT_EQ(rotations.size(), count);
    for (std::size_t t = 0; t < count; ++t) EXPECT_EQ(rotations[t], all[t]);
  }
}

TEST(ElementRotations, OfAllMethodsAreTheRotationOfARigidBody) {
  const TetMesh mesh = small_mesh();
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  std::mt19937 random(5);
  for (int k = 0; k < 20; ++k) {
    const Mat3 r = random_rotation(random);
    for (const auto method :
         {RotationMethod::polar, RotationMethod::qr, RotationMethod::gram_schmidt}) {
      std::vector<Mat3> rotations;
      model.element_rotations(shape_of(mesh, r), rotations, method);
      for (const Mat3& found : rotations) EXPECT_LT((found - r).norm(), 1e-12);
    }
  }
}

TEST(ElementRotations, ByQrTurnWithAStrainedBodyButGramSchmidtDoesNot) {
  const TetMesh mesh = small_mesh();
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  std::mt19937 random(6);
  const Mat3 r = random_rotation(random);
  const Eigen::VectorXd x = shape_of(mesh, Mat3::Identity(), 0.01);
  Eigen::VectorXd turned(x.size());
  for (Eigen::Index n = 0; n < x.size() / 3; ++n) turned.segment<3>(3 * n) = r * x.segment<3>(3 * n);
  const auto largest_difference = [&](RotationMethod method) {
    std::vector<Mat3> before, after;
    model.element_rotations(x, before, method);
    model.element_rotations(turned, after, method);
    double largest = 0;
    for (std::size_t t = 0; t < before.size(); ++t) {
      expect_rotation(after[t]);
      largest = std::max(largest, (after[t] - r * before[t]).norm());
    }
    return largest;
  };
  EXPECT_LT(largest_difference(RotationMethod::polar), 1e-11);
  EXPECT_LT(largest_difference(RotationMethod::qr), 1e-11);
  EXPECT_GT(largest_difference(RotationMethod::gram_schmidt), 1e-2);
}

TEST(ElementRotations, ByQrAndGramSchmidtSurviveCollapse) {
  const TetMesh mesh = small_mesh();
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  for (const Vec3& stretch : {Vec3(0, 0, 0), Vec3(0, 1, 1), Vec3(1, 0, 0), Vec3(1, 1, -1)})
    for (const auto method : {RotationMethod::qr, RotationMethod::gram_schmidt}) {
      std::vector<Mat3> rotations;
      model.element_rotations(shape_of(mesh, stretch.asDiagonal()), rotations, method);
      for (const Mat3& found : rotations) expect_rotation(found);
    }
}

TEST(NodeRotations, AreTheProjectedMeansOfTheIncidentElements) {
  const TetMesh mesh = small_mesh();
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  const Eigen::VectorXd x = shape_of(mesh, Mat3::Identity(), 0.01);
  std::vector<Mat3> rotations, nodes;
  model.element_rotations(x, rotations);
  model.node_rotations(rotations, nodes);
  std::vector<Mat3> sums(mesh.nodes.size(), Mat3::Zero());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (const Index node : mesh.tets[t]) sums[std::size_t(node)] += model.volumes()[t] * rotations[t];
  for (std::size_t n = 0; n < nodes.size(); ++n)
    EXPECT_LT((nodes[n] - polar_rotation(sums[n])).norm(), 1e-12);
  std::vector<Mat3> parts(nodes.size());
  for (Index n = 0; n < model.node_count(); n += 7)
    model.nodes().mean_rotations(rotations, model.volumes(), {n, std::min(n + 7, model.node_count())},
                                 parts.data());
  EXPECT_EQ(parts, nodes);
}

TEST(ElementForces, AndEnergyEqualTheSlowWay) {
  const TetMesh mesh = small_mesh();
  for (const Material& material : {material_of(1e4, 0.4, 1000), material_of(1e4, -0.3, 1000),
                                   material_of(1e4, 0.4999, 1000), striped(mesh)}) {
    const auto model = model_of(mesh, material);
    const NaiveElements naive(mesh, material);
    std::mt19937 random(7);
    for (const double noise : {1e-3, 0.02, 0.1}) {
      const Eigen::VectorXd x = shape_of(mesh, random_rotation(random), noise);
      std::vector<Mat3> rotations;
      model.element_rotations(x, rotations);
      double energy = 0;
      const Eigen::VectorXd expected = naive.forces(x, rotations, energy);
      Eigen::VectorXd f = Eigen::VectorXd::Zero(x.size());
      model.add_elastic_forces(x, rotations, f);
      EXPECT_LT((f - expected).norm() / expected.norm(), 1e-12);
      EXPECT_NEAR(model.elastic_energy(x, rotations), energy, 1e-12 * energy);
    }
  }
}

TEST(ElementForces, AreMinusTheGradientOfTheEnergyAlsoWhereElementsAreInverted) {
  const TetMesh mesh = irregular_box_mesh({2, 2, 2}, {0, 0, 0}, {0.2, 0.2, 0.2}, 0.8);
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  const NaiveElements naive(mesh, material_of(1e4, 0.4, 1000));
  const Eigen::VectorXd x = shape_of(mesh, Mat3::Identity(), 0.04);
  int inverted = 0;
  double least = 1;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    inverted += naive.gradient(t, x).determinant() < 0;
    least = std::min(least, uniqueness(naive.gradient(t, x)));
  }
  ASSERT_GT(inverted, 3);
  ASSERT_GT(least, 1e-3);  // the energy has a kink where the rotation is not unique
  std::vector<Mat3> rotations;
  model.element_rotations(x, rotations);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(x.size()), gradient(x.size());
  model.add_elastic_forces(x, rotations, f);
  const auto energy = [&](const Eigen::VectorXd& at) {
    model.element_rotations(at, rotations);
    return model.elastic_energy(at, rotations);
  };
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Eigen::VectorXd ahead = x, behind = x;
    ahead[i] += 1e-7;
    behind[i] -= 1e-7;
    gradient[i] = (energy(ahead) - energy(behind)) / 2e-7;
  }
  EXPECT_LT((f + gradient).norm() / f.norm(), 1e-6);
}

TEST(ElementTerms, InOnePassAreTheSameBitsAsOneByOne) {
  const TetMesh mesh = small_mesh();
  const auto model = model_of(mesh, striped(mesh));
  for (const double noise : {1e-3, 0.05}) {
    const Eigen::VectorXd x = shape_of(mesh, Mat3::Identity(), noise);
    std::vector<Mat3> rotations, alone;
    CornerVectors gradients = model.make_corner_vectors(), corner_forces = gradients;
    model.evaluate_elements(x, RotationMethod::polar, rotations, gradients, corner_forces);
    model.element_rotations(x, alone);
    EXPECT_EQ(rotations, alone);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(x.size()), f_alone = f;
    model.add_corner_forces(corner_forces, f);
    model.add_elastic_forces(x, alone, f_alone);
    EXPECT_EQ(f, f_alone);
    BlockMatrix a(model.pattern()), a_alone(model.pattern());
    model.assemble(3, 2, gradients, a);
    model.assemble(3, 2, alone, a_alone);
    EXPECT_EQ(a.values, a_alone.values);
  }
}

TEST(ElementTerms, AllocateNothing) {
  const TetMesh mesh = small_mesh();
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  const Eigen::VectorXd x = shape_of(mesh, Mat3::Identity(), 0.01);
  std::vector<Mat3> rotations(mesh.tets.size()), nodes(mesh.nodes.size());
  CornerVectors gradients = model.make_corner_vectors(), corner_forces = gradients;
  BlockMatrix a(model.pattern());
  Eigen::VectorXd f = Eigen::VectorXd::Zero(x.size()), y = f;
  const std::vector<char> is_held(mesh.nodes.size(), 1);
  const std::size_t before = test::allocation_count();
  model.evaluate_elements(x, RotationMethod::polar, rotations, gradients, corner_forces);
  model.node_rotations(rotations, nodes);
  model.add_corner_forces(corner_forces, f);
  model.assemble(1, 1, gradients, a);
  model.hold_nodes(is_held, a);
  multiply(a, x, y);
  EXPECT_EQ(test::allocation_count() - before, 0u);
}

double relative_difference(const BlockMatrix& a, const BlockMatrix& b) {
  const auto map = [](const BlockMatrix& m) {
    return Eigen::Map<const Eigen::VectorXd>(m.values.data(), Eigen::Index(m.values.size()));
  };
  return (map(a) - map(b)).norm() / map(b).norm();
}

TEST(Assembly, EqualsTheSumOfTheElementsForAnyMaterial) {
  const TetMesh mesh = small_mesh();
  for (const Material& material : {material_of(1e4, 0.4, 1000), material_of(1e4, -0.3, 1000),
                                   material_of(1e4, 0.4999, 1000), striped(mesh)}) {
    const auto model = model_of(mesh, material);
    const NaiveElements naive(mesh, material);
    const auto rotations = naive.rotations(shape_of(mesh, Mat3::Identity(), 0.05));
    BlockMatrix a(model.pattern());
    model.assemble(0, 1, rotations, a);
    EXPECT_LT(relative_difference(a, naive.stiffness(rotations, model.pattern())), 1e-13);
    BlockMatrix with_mass(model.pattern());
    model.assemble(1e4, 3, rotations, with_mass);
    for (Index row = 0; row < model.node_count(); ++row)
      for (Index b = model.pattern().row_begin[row]; b < model.pattern().row_begin[row + 1]; ++b) {
        Mat3 expected = 3 * a.block(b);
        if (b == model.pattern().diagonal[row])
          expected.diagonal().array() += 1e4 * model.masses()[std::size_t(row)];
        EXPECT_LT((with_mass.block(b) - expected).norm(), 1e-13 * expected.norm() + 1e-300);
      }
  }
}

TEST(Assembly, IsSymmetricToTheLastBit) {
  const TetMesh mesh = small_mesh();
  for (const Material& material : {material_of(1e4, 0.4, 1000), striped(mesh)}) {
    const auto model = model_of(mesh, material);
    const BlockPattern& pattern = model.pattern();
    std::vector<Mat3> rotations;
    model.element_rotations(shape_of(mesh, Mat3::Identity(), 0.05), rotations);
    BlockMatrix a(pattern);
    model.assemble(1e4, 2, rotations, a);
    for (Index row = 0; row < pattern.node_count(); ++row)
      for (Index b = pattern.row_begin[row]; b < pattern.row_begin[row + 1]; ++b) {
        const Mat3 mirrored = a.block(pattern.find(pattern.column[b], row)).transpose();
        EXPECT_EQ(Mat3(a.block(b)), mirrored);
      }
  }
}

TEST(Assembly, TakesNoForceForATranslation) {
  const TetMesh mesh = small_mesh();
  const auto model = model_of(mesh, striped(mesh));
  std::vector<Mat3> rotations;
  model.element_rotations(shape_of(mesh, Mat3::Identity(), 0.05), rotations);
  BlockMatrix a(model.pattern());
  model.assemble(0, 1, rotations, a);
  Eigen::VectorXd x(3 * model.node_count()), y(x.size());
  for (Index node = 0; node < model.node_count(); ++node) node_entry(x, node) = Vec3(1, -2, 3);
  multiply(a, x, y);
  for (Index node = 0; node < model.node_count(); ++node)
    EXPECT_LT(node_entry(y, node).norm(), 1e-13 * a.block(model.pattern().diagonal[node]).norm());
}

TEST(Assembly, IsTheSameBitsInAnyOrderOfBands) {
  const TetMesh mesh = irregular_box_mesh({6, 6, 6}, {0, 0, 0}, {0.2, 0.2, 0.2}, 0.8);
  const auto model = model_of(mesh, striped(mesh));
  const Eigen::VectorXd x = shape_of(mesh, Mat3::Identity(), 0.02);
  std::vector<Mat3> rotations;
  CornerVectors gradients = model.make_corner_vectors(), corner_forces = gradients;
  model.evaluate_elements(x, RotationMethod::polar, rotations, gradients, corner_forces);
  BlockMatrix a(model.pattern()), by_bands(model.pattern());
  model.assemble(1e4, 2, gradients, a);
  const IndexRange bands = model.plan().all_bands();
  ASSERT_GT(bands.end, 4);
  for (Index band = bands.end; band-- > 0;)
    model.plan().assemble_off_diagonal(gradients, 2, {band, band + 1}, by_bands);
  for (Index band = bands.end; band-- > 0;)
    model.plan().assemble_diagonal(1e4, model.masses(), {band, band + 1}, by_bands);
  EXPECT_EQ(a.values, by_bands.values);
}

TEST(Assembly, HeldNodesGetIdentityRowsAndColumnsAndTheRestStays) {
  const TetMesh mesh = small_mesh();
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  const BlockPattern& pattern = model.pattern();
  BlockMatrix a(pattern);
  model.assemble_rest(1e4, 2, a);
  BlockMatrix held = a;
  std::vector<char> is_held(mesh.nodes.size(), 0);
  for (std::size_t node = 0; node < is_held.size(); node += 3) is_held[node] = 1;
  model.hold_nodes(is_held, held);
  for (Index row = 0; row < pattern.node_count(); ++row)
    for (Index b = pattern.row_begin[row]; b < pattern.row_begin[row + 1]; ++b) {
      const Index column = pattern.column[b];
      Mat3 expected = a.block(b);
      if (is_held[std::size_t(row)] || is_held[std::size_t(column)])
        expected = (row == column ? 1.0 : 0.0) * Mat3::Identity();
      EXPECT_EQ(Mat3(held.block(b)), expected);
    }
}

TEST(BlockProduct, EqualsTheSlowOneInBothPrecisionsAndAnyRange) {
  const TetMesh mesh = small_mesh();
  const auto model = model_of(mesh, material_of(1e4, 0.4, 1000));
  const BlockPattern& pattern = model.pattern();
  BlockMatrix a(pattern);
  BlockMatrixF single(pattern);
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    a.values[i] = normal(random);
    single.values[i] = float(a.values[i]);
  }
  const Eigen::VectorXd x = Eigen::VectorXd::Random(3 * pattern.node_count());
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(x.size()), y(x.size()), parts(x.size());
  for (Index row = 0; row < pattern.node_count(); ++row)
    for (Index b = pattern.row_begin[row]; b < pattern.row_begin[row + 1]; ++b)
      node_entry(expected, row) += Mat3(a.block(b)) * node_entry(x, pattern.column[b]);
  multiply(a, x, y);
  EXPECT_LT((y - expected).norm() / expected.norm(), 1e-15);
  for (Index row = 0; row < pattern.node_count(); ++row)
    multiply_rows(a, x.data(), {row, row + 1}, parts.data());
  EXPECT_EQ(y, parts);
  const Eigen::VectorXf single_x = x.cast<float>();
  Eigen::VectorXf single_y(x.size());
  multiply(single, single_x, single_y);
  EXPECT_LT((single_y.cast<double>() - expected).norm() / expected.norm(), 5e-7);
}

/// TetGen's two text files.
TetMesh read_tetgen(const std::filesystem::path& stem) {
  std::ifstream nodes(stem.string() + ".node"), tets(stem.string() + ".ele");
  std::size_t count = 0, number = 0, skip = 0;
  TetMesh mesh;
  nodes >> count >> skip >> skip >> skip;
  mesh.nodes.resize(count);
  for (Point& p : mesh.nodes) nodes >> number >> p[0] >> p[1] >> p[2];
  tets >> count >> skip >> skip;
  mesh.tets.resize(count);
  for (Tet& t : mesh.tets) tets >> number >> t[0] >> t[1] >> t[2] >> t[3];
  for (Tet& t : mesh.tets)
    if (signed_volume6(mesh.nodes[std::size_t(t[0])], mesh.nodes[std::size_t(t[1])],
                       mesh.nodes[std::size_t(t[2])], mesh.nodes[std::size_t(t[3])]) < 0)
      std::swap(t[2], t[3]);
  return mesh;
}

std::filesystem::path data_folder() {
  const char* chosen = std::getenv("SOUPLE_DATA_DIR");
  return chosen ? chosen : SOUPLE_DEFAULT_DATA_DIR;
}

TEST(ElementTerms, OfARealBodyThatIsTwistedAndCrushedEqualTheSlowWay) {
  const auto stem = data_folder() / "tets/armadillo_4k";
  if (!std::filesystem::exists(stem.string() + ".ele")) {
    if (std::getenv("CI")) FAIL() << "no data at " << stem;
    GTEST_SKIP() << "no data at " << stem;
  }
  const TetMesh mesh = read_tetgen(stem);
  ASSERT_GT(mesh.tets.size(), 3000u);
  const Material material = material_of(1e4, 0.4, 1000);
  const auto model = model_of(mesh, material);
  const NaiveElements naive(mesh, material);
  for (const double crush : {1.0, 0.1, -0.4}) {
    Eigen::VectorXd x = shape_of(mesh, Vec3(1, 1, crush).asDiagonal());
    for (Eigen::Index n = 0; n < x.size() / 3; ++n)
      x.segment<3>(3 * n) = Eigen::AngleAxisd(2 * x[3 * n], Vec3::UnitX()) * Vec3(x.segment<3>(3 * n));
    std::vector<Mat3> rotations;
    CornerVectors gradients = model.make_corner_vectors(), corner_forces = gradients;
    model.evaluate_elements(x, RotationMethod::polar, rotations, gradients, corner_forces);
    const auto expected_rotations = naive.rotations(x);
    for (std::size_t t = 0; t < rotations.size(); ++t)
      if (uniqueness(naive.gradient(t, x)) > 1e-3) {
        EXPECT_LT((rotations[t] - expected_rotations[t]).norm(), 1e-10);
      }
    double energy = 0;
    const Eigen::VectorXd expected = naive.forces(x, rotations, energy);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(x.size());
    model.add_corner_forces(corner_forces, f);
    EXPECT_LT((f - expected).norm() / expected.norm(), 1e-12);
    BlockMatrix a(model.pattern());
    model.assemble(0, 1, gradients, a);
    EXPECT_LT(relative_difference(a, naive.stiffness(rotations, model.pattern())), 1e-13);
  }
}

}  // namespace
}  // namespace souple
