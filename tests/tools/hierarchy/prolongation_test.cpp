// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime's prolongation against what the hierarchy was made by and what it says of itself.
#include "runtime/multigrid/prolongation.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "tests/tools/hierarchy/hierarchy_shapes.hpp"
#include "tests/tools/real_surface.hpp"
#include "tools/hierarchy/embedded_hierarchy.hpp"
#include "tools/hierarchy/nested_hierarchy.hpp"
#include "tools/hierarchy/refine.hpp"
#include "tools/hierarchy/wavelet.hpp"

namespace souple {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

std::vector<double> carried(const Prolongation& p, const std::vector<double>& coarse) {
  std::vector<double> fine(3 * at(p.fine_count()), 0);
  for (Index i = 0; i < p.fine_count(); ++i)
    for (Index k = p.row_begin[at(i)]; k < p.row_begin[at(i) + 1]; ++k)
      for (std::size_t x = 0; x < 3; ++x)
        fine[3 * at(i) + x] += p.weight[at(k)] * coarse[3 * at(p.column[at(k)]) + x];
  return fine;
}

TEST(ProlongationOfLevels, NestedIsTheSynthesisOfTheWaveletWithoutDetails) {
  std::vector<MeshLevel> levels(3);
  levels[0].mesh = kuhn_cube(2);
  std::vector<ParentRows> parents;
  for (std::size_t l = 1; l < 3; ++l) {
    RefinedMesh fine = refine_red(levels[l - 1].mesh, DiagonalRule::shortest);
    levels[l].mesh = std::move(fine.mesh);
    levels[l].parents = std::move(fine.parents);
    parents.push_back(levels[l].parents);
  }
  const auto wavelet = NestedWavelet::make(parents, levels[0].mesh.nodes.size());
  ASSERT_TRUE(wavelet.ok());
  std::mt19937 random(2);
  std::uniform_int_distribution<int> whole(-1000, 1000);
  std::vector<double> values(3 * levels[0].mesh.nodes.size());
  for (double& v : values) v = whole(random);
  std::vector<double> synthesis = values;
  synthesis.resize(3 * wavelet->node_count(), 0);
  wavelet->inverse(synthesis, 3);
  for (std::size_t l = 1; l < 3; ++l)
    values = carried(prolongation_of(levels[l], levels[l - 1]).value(), values);
  EXPECT_EQ(values, synthesis);
}

/// Rotations about the centroid, worst axis, as RigidMotionError has it.
double rotation_error(const Prolongation& p, const MeshLevel& fine, const MeshLevel& coarse) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Point& x : fine.mesh.nodes) centre += as_vec3(x) / double(fine.mesh.nodes.size());
  double worst = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto rotation = [&](const std::vector<Point>& nodes) {
      std::vector<double> motion;
      for (const Point& x : nodes) {
        const Vec3 r = Vec3::Unit(axis).cross(as_vec3(x) - centre);
        motion.insert(motion.end(), r.begin(), r.end());
      }
      return motion;
    };
    const std::vector<double> moved = carried(p, rotation(coarse.mesh.nodes));
    const std::vector<double> wanted = rotation(fine.mesh.nodes);
    const Eigen::Map<const Eigen::VectorXd> a(moved.data(), Eigen::Index(moved.size()));
    const Eigen::Map<const Eigen::VectorXd> b(wanted.data(), Eigen::Index(wanted.size()));
    worst = std::max(worst, (a - b).norm() / b.norm());
  }
  return worst;
}

void expect_rigid_motions(const std::vector<MeshLevel>& levels) {
  for (std::size_t l = 1; l < levels.size(); ++l) {
    const Prolongation p = prolongation_of(levels[l], levels[l - 1]).value();
    for (const double x : carried(p, std::vector<double>(3 * levels[l - 1].mesh.nodes.size(), 1)))
      EXPECT_NEAR(x, 1, 1e-13);
    EXPECT_NEAR(rotation_error(p, levels[l], levels[l - 1]), levels[l].rigid_motion_error.embedding,
                1e-9);
    // By the parents alone moved midpoints are carried as badly as the level says.
    if (levels[l].parents.empty()) continue;
    MeshLevel nested = levels[l];
    nested.embedding.clear();
    const Prolongation halves = prolongation_of(nested, levels[l - 1]).value();
    const double error = rotation_error(halves, levels[l], levels[l - 1]);
    EXPECT_NEAR(error, levels[l].rigid_motion_error.parents, 1e-9);
    EXPECT_GT(error, 1e-3);
  }
}

TEST(ProlongationOfLevels, CarriesRigidMotionsOfAFittedLiverAsItSays) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver-smooth.obj");
  const auto hierarchy = build_nested_hierarchy(coarse_mesh(surface, 120), surface, {3});
  ASSERT_TRUE(hierarchy.ok()) << format_issue(hierarchy.issue());
  expect_rigid_motions(hierarchy->levels);
}

TEST(ProlongationOfLevels, CarriesRigidMotionsOfAnEmbeddedLiverAsItSays) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const TriangleMesh surface = closed_real_surface("liver-smooth.obj");
  const auto hierarchy =
      build_embedded_hierarchy({coarse_mesh(surface, 150), coarse_mesh(surface, 1200)}, surface);
  ASSERT_TRUE(hierarchy.ok()) << format_issue(hierarchy.issue());
  expect_rigid_motions(hierarchy->levels);
}

}  // namespace
}  // namespace souple
