// SPDX-License-Identifier: GPL-3.0-or-later
// References 2.1, 2.2 and 2.4: a block that is large against what presses on it is a half-space. The
// compliance of the middle of its top face, as it is stored and read back, against the closed forms.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "runtime/compliance/open_variant.hpp"
#include "tests/support/box_mesh.hpp"
#include "tools/compliance/precompute.hpp"

namespace souple {
namespace {

constexpr double young_pa = 1e6, poisson = 0.3;
constexpr double shear_pa = young_pa / (2 * (1 + poisson));
/// Side of the block over 2, m; the mesh is graded towards the middle of the top face.
constexpr double half_side = 1;
constexpr double grading = 4;

double graded(double t) { return half_side * std::sinh(grading * t) / std::sinh(grading); }

/// Cells: 2 half x 2 half x half, top face at z = 0.
TetMesh graded_block(int half) {
  TetMesh mesh = test::box_mesh({2 * half, 2 * half, half}, {-1, -1, -1}, {2, 2, 1});
  for (Point& p : mesh.nodes) p = {graded(p[0]), graded(p[1]), graded(p[2])};
  return mesh;
}

/// The block held at its bottom and sides, and its compliance on the middle of the top face.
struct HalfSpace {
  int half;  ///< cells from the middle to a side
  MeshLevel level;
  std::vector<Index> nodes;
  Eigen::MatrixXd compliance;

  HalfSpace(int half_cells, double tolerance)
      : half(half_cells), level(test::level_of(graded_block(half_cells))) {
    FixedSet fixed{"outside", {}};
    CompliancePrecomputeOptions options;
    options.kind = ComplianceKind::static_equilibrium;
    options.tolerance = tolerance;
    for (std::size_t n = 0; n < level.mesh.nodes.size(); ++n) {
      const Point& p = level.mesh.nodes[n];
      const double side = std::max(std::abs(p[0]), std::abs(p[1]));
      if (side > half_side - 1e-9 || p[2] < -half_side + 1e-9)
        fixed.nodes.push_back(Index(n));
      else if (p[2] > -1e-12 && side < 0.35)
        options.nodes.push_back(Index(n));
    }
    auto variant = precompute_compliance(level, nullptr, test::material_of(young_pa, poisson, 1000),
                                         &fixed, options, {});
    if (!variant) {
      ADD_FAILURE() << format_issue(variant.issue());
      return;
    }
    nodes = variant->nodes;
    EXPECT_EQ(nodes, options.nodes);
    read_back(*variant);
  }

  const Point& position(std::size_t row) const { return level.mesh.nodes[std::size_t(nodes[row])]; }

  /// Nodal areas of the square |x|, |y| <= reach (a node line of the mesh): a uniform pressure's loads.
  Eigen::VectorXd square_areas(double reach) const {
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(Eigen::Index(nodes.size()));
    std::vector<Index> row(level.mesh.nodes.size(), -1);
    for (std::size_t k = 0; k < nodes.size(); ++k) row[std::size_t(nodes[k])] = Index(k);
    for (const Triangle& t : level.boundary) {
      double area = 0, farthest = 0;
      const auto corner = [&](std::size_t k) { return level.mesh.nodes[std::size_t(t[k])]; };
      for (std::size_t k = 0; k < 3; ++k) {
        farthest = std::max({farthest, std::abs(corner(k)[0]), std::abs(corner(k)[1])});
        if (corner(k)[2] < -1e-12) farthest = HUGE_VAL;
      }
      if (farthest > reach + 1e-9) continue;
      area = std::abs((corner(1)[0] - corner(0)[0]) * (corner(2)[1] - corner(0)[1]) -
                      (corner(1)[1] - corner(0)[1]) * (corner(2)[0] - corner(0)[0])) /
             2;
      for (std::size_t k = 0; k < 3; ++k) areas[row[std::size_t(t[k])]] += area / 3;
    }
    return areas;
  }

  /// Displacements along `out` where `load` (N, along `in`) acts, by node.
  Eigen::VectorXd respond(const Eigen::VectorXd& load, int in, int out) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(compliance.rows());
    for (Eigen::Index k = 0; k < load.size(); ++k) force[3 * k + in] = load[k];
    const Eigen::VectorXd u = compliance * force;
    Eigen::VectorXd component(load.size());
    for (Eigen::Index k = 0; k < load.size(); ++k) component[k] = u[3 * k + out];
    return component;
  }

 private:
  void read_back(const ComplianceVariant& variant) {
    const auto opened = open_variant(variant);
    ASSERT_TRUE(opened.ok()) << format_issue(opened.issue());
    std::vector<Index> rows(nodes.size());
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = Index(k);
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> block(3 * rows.size(),
                                                                                3 * rows.size());
    ComplianceWork work;
    (*opened)->gather_block(rows, rows, block.data(), 3 * rows.size(), work);
    compliance = block.cast<double>();
  }
};

/// Half the side of a square of 2 `cells` cells a side.
double patch(int half, int cells) { return graded(double(cells) / half); }

/// Boussinesq's vertical displacement at distance r of 1 N, m.
double boussinesq(double r) { return (1 - poisson) / (2 * std::numbers::pi * shear_pa * r); }

/// 1 N on the four cells around the middle of the top face.
struct PointLoad {
  double half;  ///< half the side of the cells, m
  Eigen::VectorXd load;
  explicit PointLoad(const HalfSpace& block)
      : half(patch(block.half, 1)), load(block.square_areas(half) / (4 * half * half)) {}
  /// Nearer, the four cells are no point (and a cell is a fifth of r); farther, the walls bend the
  /// field.
  bool compares_at(double r) const { return r > 8 * half && r < 0.25 * half_side; }
};

/// What the walls of the block hold back of every displacement near its middle, m per N: the same
/// everywhere there, about that of a point load at their distance.
double held_back(const HalfSpace& block) {
  const PointLoad point(block);
  const Eigen::VectorXd u = block.respond(point.load, 2, 2);
  double sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < block.nodes.size(); ++k) {
    const double r = std::hypot(block.position(k)[0], block.position(k)[1]);
    if (!point.compares_at(r)) continue;
    sum += boussinesq(r) - u[Eigen::Index(k)];
    ++count;
  }
  return sum / count;
}

TEST(HalfSpace, FollowsBoussinesqAndCerrutiAwayFromTheLoad) {
  const HalfSpace block(16, 1e-4);
  const PointLoad point(block);
  const double held = held_back(block);
  EXPECT_GT(held, boussinesq(half_side));
  EXPECT_LT(held, 2 * boussinesq(half_side));
  const Eigen::VectorXd uz = block.respond(point.load, 2, 2), ux = block.respond(point.load, 0, 0),
                        uy = block.respond(point.load, 0, 1), uzx = block.respond(point.load, 0, 2);
  double held_x = 0;
  int compared = 0;
  const auto cerruti = [](double x, double r) {
    return boussinesq(r) * (1 + poisson / (1 - poisson) * x * x / (r * r));
  };
  for (const bool measuring : {true, false})
    for (std::size_t k = 0; k < block.nodes.size(); ++k) {
      const double x = block.position(k)[0], y = block.position(k)[1], r = std::hypot(x, y);
      if (!point.compares_at(r)) continue;
      const auto i = Eigen::Index(k);
      if (measuring) {
        held_x += cerruti(x, r) - ux[i];
        ++compared;
        continue;
      }
      const double unit = boussinesq(r);
      EXPECT_NEAR(uz[i], unit - held, 0.03 * unit) << x << " " << y;
      EXPECT_NEAR(ux[i], cerruti(x, r) - held_x / compared, 0.05 * unit) << x << " " << y;
      EXPECT_NEAR(uy[i], poisson / (1 - poisson) * x * y / (r * r) * unit, 0.05 * unit);
      EXPECT_NEAR(std::abs(uzx[i]), (1 - 2 * poisson) / (2 - 2 * poisson) * std::abs(x) / r * unit,
                  0.05 * unit);
    }
  EXPECT_GT(compared, 50);
}

TEST(HalfSpace, GivesUnderAUniformPressureWhatLoveFound) {
  const HalfSpace block(16, 1e-4);
  const double a = patch(16, 6), side = 2 * a, pressure = 100;
  const Eigen::VectorXd areas = block.square_areas(a);
  ASSERT_NEAR(areas.sum(), side * side, 1e-12);
  const Eigen::VectorXd u = block.respond(pressure * areas, 2, 2);
  const double unit = (1 - poisson * poisson) * pressure * side / young_pa;
  const double held = held_back(block) * pressure * side * side;
  EXPECT_NEAR(u.dot(areas) / areas.sum(), 0.946402 * unit - held, 0.05 * unit);
  double centre = 0;
  for (std::size_t k = 0; k < block.nodes.size(); ++k)
    if (std::hypot(block.position(k)[0], block.position(k)[1]) < 1e-12) centre = u[Eigen::Index(k)];
  EXPECT_NEAR(centre, 1.12220 * unit - held, 0.05 * unit);
}

/// Over what a rigid square punch of half side `a` takes: 1.012 times a circle of its area (King 1987).
double punch_force_ratio(int half, int cells) {
  const HalfSpace block(half, 1e-4);
  const double a = patch(half, cells), depth = 1e-3;
  std::vector<Eigen::Index> under;
  for (std::size_t k = 0; k < block.nodes.size(); ++k)
    if (std::max(std::abs(block.position(k)[0]), std::abs(block.position(k)[1])) < a + 1e-9)
      under.push_back(3 * Eigen::Index(k) + 2);
  const Eigen::MatrixXd normal = block.compliance(under, under);
  const Eigen::VectorXd force =
      normal.llt().solve(Eigen::VectorXd::Constant(Eigen::Index(under.size()), depth));
  // The pressure rises towards the edge of a punch.
  EXPECT_GT(force.maxCoeff(), 1.5 * force.mean());
  const double modulus = young_pa / (1 - poisson * poisson);
  const double radius = 2 * a / std::sqrt(std::numbers::pi);
  return force.sum() / (1.012 * 2 * radius * modulus * (depth + held_back(block) * force.sum()));
}

TEST(HalfSpace, CarriesARigidPunchAsTheClosedFormSays) {
  // The pressure's edge lies up to a cell outside the punch's nodes: the force converges from above,
  // with the cell's size.
  const double coarse = punch_force_ratio(8, 3), fine = punch_force_ratio(16, 6);
  EXPECT_GT(coarse, fine);
  EXPECT_GT(fine, 1);
  EXPECT_NEAR(2 * fine - coarse, 1, 0.06);
}

}  // namespace
}  // namespace souple
