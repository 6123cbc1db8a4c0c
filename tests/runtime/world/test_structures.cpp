// SPDX-License-Identifier: MIT
// Structures with closed forms, through the world's own loads, fixed and driven nodes.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double length = 1, side = 0.1;

struct Structure {
  World world;
  BodyId body;
};

FixedSet at_x(const TetMesh& mesh, const std::string& name, std::initializer_list<double> places) {
  FixedSet set{name, {}};
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    for (const double x : places)
      if (std::abs(mesh.nodes[n][0] - x) < 1e-9) set.nodes.push_back(Index(n));
  return set;
}

// Without a stored compliance: nothing touches.
std::shared_ptr<const SoftBodyAsset> beam(const std::array<int, 3>& cells, double young,
                                          double poisson) {
  SoftBodyContent content;
  TetMesh mesh = box_mesh(cells, {0, -side / 2, -side / 2}, {length, side, side});
  content.fixed_sets = {at_x(mesh, "wall", {0}), at_x(mesh, "ends", {0, length}),
                        at_x(mesh, "tip", {length})};
  content.level = level_of(std::move(mesh));
  content.material = material_of(young, poisson, 7850);
  auto asset = SoftBodyAsset::create(std::move(content));
  EXPECT_TRUE(asset.ok());
  return *asset;
}

Structure hold(std::shared_ptr<const SoftBodyAsset> asset, const std::string& fixed,
               std::vector<DrivenSet> driven = {}) {
  WorldSettings settings;
  settings.integrator = Integrator::quasi_static;
  settings.contact_method = ContactMethod::exact;
  settings.gravity_m_s2 = {0, 0, 0};
  settings.free_motion = {.tolerance = 1e-9, .max_iterations = 20000};
  Structure s{make_world(settings), {}};
  SoftBodyDescription description;
  description.fixed_set = fixed;
  description.driven = std::move(driven);
  auto body = s.world.add_soft_body(std::move(asset), description);
  EXPECT_TRUE(body.ok());
  s.body = *body;
  return s;
}

std::vector<Index> end_face(const SoftBodyAsset& asset) {
  std::vector<Index> face;
  const auto rest = asset.model().rest_positions();
  const auto triangles = asset.surface().triangles();
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (std::ranges::all_of(triangles[t],
                            [&](Index n) { return rest[std::size_t(n)][0] > length - 1e-9; }))
      face.push_back(Index(t));
  return face;
}

Vec3 mean_shift(const Structure& s, const std::string& set) {
  const SoftBodyAsset& asset = s.world.asset(s.body);
  Vec3 mean = Vec3::Zero();
  const auto& nodes = asset.find_fixed_set(set)->nodes;
  for (const Index n : nodes)
    mean += (as_vec3(s.world.positions(s.body)[std::size_t(n)]) -
             as_vec3(asset.model().rest_positions()[std::size_t(n)])) /
            double(nodes.size());
  return mean;
}

Vec3 tip_shift_under(std::shared_ptr<const SoftBodyAsset> asset, const Vec3& traction) {
  Structure s = hold(asset, "wall");
  LoadDescription load;
  load.kind = LoadKind::traction;
  load.triangles = end_face(*asset);
  load.course = {{0, as_point(traction), 0}};
  EXPECT_TRUE(s.world.add_load(s.body, load).ok());
  for (int k = 0; k < 2; ++k) step(s.world);
  return mean_shift(s, "tip");
}

TEST(Structures, AxialBarExtendsByForceTimesLengthOverStiffness) {  // 1.3; nu = 0, so that the wall
  // does not hinder the sides
  const Vec3 shift = tip_shift_under(beam({6, 2, 2}, 1e7, 0), {1, 0, 0});
  EXPECT_NEAR(shift.x(), length / 1e7, 1e-6 * length / 1e7);
  EXPECT_LT(shift.tail<2>().norm(), 1e-6 * length / 1e7);
}

// 3.1: E = 210e9, nu 0.3, F = 1000 at the tip: 1.9196e-4 m. Linear tets lock: too stiff, from below.
TEST(Structures, CantileverUnderATipLoadApproachesTimoshenkoFromBelow) {
  const double exact = 1.919619e-4;
  std::vector<double> sag;
  for (const int n : {1, 2, 4})
    sag.push_back(tip_shift_under(beam({10 * n, n, n}, 210e9, 0.3), {0, 0, 1e5}).z());
  EXPECT_GT(sag[0], 0.1 * exact);
  EXPECT_GT(sag[1], sag[0]);
  EXPECT_GT(sag[2], sag[1]);
  EXPECT_LT(sag[2], exact);
  // The error falls nearly by 4: order two.
  EXPECT_NEAR((exact - sag[1]) / (exact - sag[2]), 3, 0.8);
}

// 3.8: bending does not feel nu, but linear tets do.
TEST(Structures, NearlyIncompressibleBendingLocksButIsSolved) {
  const double free = tip_shift_under(beam({20, 2, 2}, 210e9, 0.3), {0, 0, 1e5}).z();
  double last = free;
  for (const double poisson : {0.45, 0.49, 0.499}) {
    const double sag = tip_shift_under(beam({20, 2, 2}, 210e9, poisson), {0, 0, 1e5}).z();
    EXPECT_LT(sag, last) << poisson;
    EXPECT_GT(sag, 0.02 * free) << poisson;
    last = sag;
  }
}

// 3.2: half the torque times the angle is the energy: G J phi^2 / (2 L), J = 0.140577 s^4. Both ends
// are kept from warping, which stiffens about a side's length of bar at each of them.
TEST(Structures, TwistedBarStoresTheEnergyOfTorsionFromAbove) {
  const double young = 1e6, poisson = 0.3, angle = 1e-3;
  const double exact =
      young / (2 * (1 + poisson)) * 0.140577 * std::pow(side, 4) * angle * angle / (2 * length);
  std::vector<double> energy;
  for (const int n : {2, 4, 8}) {
    const Pose twisted = pose_of(turned(angle * 180 / M_PI, {1, 0, 0}), Vec3::Zero());
    Structure s =
        hold(beam({5 * n, n, n}, young, poisson), "ends", {{"tip", {{0, {}}, {0.01, twisted}}}});
    StepReport report;
    for (int k = 0; k < 3; ++k) report = step(s.world);
    energy.push_back(report.elastic_energy_j);
  }
  EXPECT_GT(energy[0], energy[1]);
  EXPECT_GT(energy[1], energy[2]);
  EXPECT_GT(energy[2], exact);
  const double limit = energy[2] - (energy[1] - energy[2]) / 3;  // extrapolated, order two
  EXPECT_NEAR(limit, exact, 0.08 * exact);
}

}  // namespace
}  // namespace souple
