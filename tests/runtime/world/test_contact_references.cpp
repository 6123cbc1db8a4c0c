// SPDX-License-Identifier: MIT
// Contact of elastic bodies against closed forms (references 1.5, 1.6, 1.7, 4.5, 5.2, 5.3).
#include <gtest/gtest.h>

#include <cmath>

#include "runtime/contact/contact.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/rigid_scenes.hpp"

namespace souple {
namespace {

using namespace test;

constexpr double g = 9.81;

std::shared_ptr<const SoftBodyAsset> plain_body(TetMesh mesh, const Material& material,
                                                std::vector<FixedSet> fixed) {
  SoftBodyContent content;
  content.level = level_of(std::move(mesh));
  content.material = material;
  content.fixed_sets = std::move(fixed);
  auto asset = SoftBodyAsset::create(std::move(content));
  EXPECT_TRUE(asset.ok());
  return asset.ok() ? *asset : nullptr;
}

template <class Which>
FixedSet nodes_where(const TetMesh& mesh, Which&& which) {
  FixedSet set{"held", {}};
  for (std::size_t k = 0; k < mesh.nodes.size(); ++k)
    if (which(mesh.nodes[k])) set.nodes.push_back(Index(k));
  return set;
}

WorldSettings static_settings(double friction) {
  WorldSettings settings;
  settings.integrator = Integrator::quasi_static;
  settings.contact_method = ContactMethod::exact;
  settings.gravity_m_s2 = {0, 0, 0};
  settings.friction = friction;
  return settings;
}

TEST(ContactReferences, ABarWithAGapIsStoppedByTheWall) {  // 1.6, nu = 0
  const double length = 0.2, side = 0.04, young = 1e5;
  TetMesh mesh = box_mesh({10, 2, 2}, {0, 0, 0}, {length, side, side});
  const auto asset = plain_body(mesh, material_of(young, 0, 1000),
                                {nodes_where(mesh, [](const Point& p) { return p[0] == 0; })});
  const double stiffness = young * side * side / length;
  for (const auto& [gap, load] : {std::pair(5e-4, 0.2), std::pair(5e-4, 0.6), std::pair(2e-4, 1.0)}) {
    World world = make_world(static_settings(0));
    const BodyId bar = add_soft(world, asset, Vec3::Zero(), Mat3::Identity(), Vec3::Zero(), "held");
    add_plane(world, turned(-90, {0, 1, 0}), {length + gap, 0, 0});
    LoadDescription traction;
    traction.kind = LoadKind::traction;
    const auto triangles = asset->surface().triangles();
    const auto rest = asset->model().rest_positions();
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (std::ranges::all_of(triangles[t],
                              [&](Index n) { return rest[std::size_t(n)][0] > length - 1e-9; }))
        traction.triangles.push_back(Index(t));
    traction.course = {{0, {load / (side * side), 0, 0}}};
    ASSERT_TRUE(world.add_load(bar, traction).ok());
    for (int k = 0; k < 10; ++k) step(world);
    const double wall = std::max(0.0, load - stiffness * gap);
    EXPECT_NEAR(-contact_force(world, bar).x(), wall, 1e-3 * load);
    double tip = 0;
    for (std::size_t n = 0; n < rest.size(); ++n)
      if (rest[n][0] > length - 1e-9) tip = std::max(tip, world.positions(bar)[n][0] - length);
    EXPECT_NEAR(tip, std::min(load / stiffness, gap), 1e-3 * gap);
  }
}

TEST(ContactReferences, PressureGoesThroughANonMatchingInterface) {  // 1.5, mu = 0
  const double side = 0.1, pressure = 200, young = 1e5, h = 0.01;
  // Heavily damped, so that it comes to rest; all faces slide.
  const auto block = [&](int cells, double z) {
    return make_body(box_mesh({cells, cells, cells}, {0, 0, z}, {side, side, side}),
                     material_of(young, 0.3, 100, 30, 0.02), h);
  };
  WorldSettings settings;
  settings.gravity_m_s2 = {0, 0, 0};
  settings.friction = 0;
  World world = make_world(settings);
  const BodyId lower = add_soft(world, block(3, 0), Vec3::Zero());
  const BodyId upper = add_soft(world, block(4, side), Vec3::Zero());
  add_plane(world);
  LoadDescription load;
  load.kind = LoadKind::traction;
  const auto& asset = world.asset(upper);
  const auto rest = asset.model().rest_positions();
  for (std::size_t t = 0; t < asset.surface().triangles().size(); ++t)
    if (std::ranges::all_of(asset.surface().triangles()[t],
                            [&](Index n) { return rest[std::size_t(n)][2] > 2 * side - 1e-9; }))
      load.triangles.push_back(Index(t));
  load.course = {{0, {0, 0, -pressure}}};
  ASSERT_TRUE(world.add_load(upper, load).ok());
  for (int k = 0; k < 400; ++k) step(world);
  const double shorter = pressure * side / young;
  double top = 0, middle = 0, worst_top = 0;
  std::size_t tops = 0, middles = 0;
  for (std::size_t n = 0; n < rest.size(); ++n) {
    const double down = rest[n][2] - world.positions(upper)[n][2];
    if (rest[n][2] > 2 * side - 1e-9)
      top += down, ++tops, worst_top = std::max(worst_top, std::abs(down - 2 * shorter));
    if (rest[n][2] < side + 1e-9) middle += down, ++middles;
  }
  EXPECT_NEAR(contact_force(world, lower).norm(), 0, 1e-3 * pressure * side * side);
  EXPECT_NEAR(top / double(tops), 2 * shorter, 0.03 * shorter);
  EXPECT_NEAR(middle / double(middles), shorter, 0.03 * shorter);
  EXPECT_LT(worst_top, 0.1 * shorter) << "points against faces do not pass the patch test exactly";
}

TEST(ContactReferences, WorkOfEveryContactBalances) {  // 1.7
  WorldSettings settings;
  settings.friction = 0.3;
  settings.contact_solver = {1e-13, 5000};
  World world = make_world(settings);
  add_plane(world);
  const auto soft = make_body(box_mesh({3, 3, 3}, {-0.05, -0.05, 0}, {0.1, 0.1, 0.1}),
                              material_of(1e5, 0.3, 1000, 0.1, 0.01), 0.01);
  add_soft(world, soft, {0, 0, 0.001}, Mat3::Identity(), {0.5, 0.1, 0});
  add_free(world, box_shape({0.05, 0.04, 0.03}), {0.3, 0, 0.031}, turned(10, {0, 0, 1}),
           moving({1, 0, 0}));
  for (int k = 0; k < 30; ++k) {
    step(world);
    const auto p = world.contact_problem();
    const auto size = Eigen::Index(3 * p.contacts.size());
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const Eigen::VectorXd> r(p.force.data(), size);
    const Eigen::VectorXd u = Eigen::Map<const Rows>(p.delassus.data(), size, size) * r +
                              Eigen::Map<const Eigen::VectorXd>(p.free_gap.data(), size);
    const double unit = r.norm() * 0.005;  // N m, of a step's way
    for (Eigen::Index i = 0; i < size; i += 3) {
      EXPECT_LE(std::abs(u[i] * r[i]), 1e-6 * unit);
      const Vec3 f = r.segment<3>(i), slip = u.segment<3>(i);
      const double work = f.tail<2>().dot(slip.tail<2>());
      EXPECT_NEAR(work, -0.3 * f[0] * slip.tail<2>().norm(), 1e-6 * unit) << "step " << k;
    }
  }
}

TEST(ContactReferences, APlankOnThreeEqualBlocksIsCarriedByThirds) {  // 5.2
  const double h = 0.01;
  const auto block = make_body(box_mesh({2, 2, 2}, {-0.05, -0.05, 0}, {0.1, 0.1, 0.1}),
                               material_of(1e5, 0.3, 1000, 1, 0.01), h);
  World world = make_world(WorldSettings{});
  add_plane(world);
  std::vector<BodyId> blocks;
  for (int k = -1; k <= 1; ++k) blocks.push_back(add_soft(world, block, {0.3 * k, 0, 0}));
  const BodyId plank = add_free(world, box_shape({0.4, 0.06, 0.01}), {0, 0, 0.11});
  for (int k = 0; k < 600; ++k) step(world);
  const double weight = 1000 * 8 * 0.4 * 0.06 * 0.01 * g;
  for (const BodyId one : blocks)
    EXPECT_NEAR(event_force(world, one, plank).z(), weight / 3, 0.01 * weight);
}

// Between two walls that press by `squeeze` each; the floor goes away at 1 s. Fall after another
// second.
double fall_of_jammed_block(double squeeze, double mu, double& normal) {
  const double h = 0.01;
  WorldSettings settings;
  settings.friction = mu;
  World world = make_world(settings);
  const BodyId body = add_soft(world,
                               make_body(box_mesh({3, 3, 3}, {-0.05, -0.05, 0}, {0.1, 0.1, 0.1}),
                                         material_of(2e4, 0.3, 1000, 2, 0.01), h),
                               Vec3::Zero());
  const RigidShape wall = box_shape({0.05, 0.2, 0.4});
  BodyId first{};
  for (const double side : {-1.0, 1.0}) {
    const Vec3 from(side * 0.1005, 0, 0), to(side * (0.1 - squeeze), 0, 0);
    const BodyId one = add_driven(
        world, wall, {{0, pose_of(Mat3::Identity(), from)}, {0.5, pose_of(Mat3::Identity(), to)}});
    if (side < 0) first = one;
  }
  add_driven(
      world, box_shape({0.3, 0.3, 0.05}),
      {{1, pose_of(Mat3::Identity(), {0, 0, -0.05})}, {1.2, pose_of(Mat3::Identity(), {0, 0, -5})}});
  for (int k = 0; k < 100; ++k) step(world);
  const double start = centre_of_mass(world, body).z();
  for (int k = 0; k < 30; ++k) step(world);
  normal = std::abs(event_force(world, first, body).x());
  for (int k = 0; k < 70; ++k) step(world);
  return start - centre_of_mass(world, body).z();
}

TEST(ContactReferences, ABlockBetweenWallsHoldsByItsPreload) {  // 5.3: holds iff 2 mu N >= m g
  double normal = 0;
  // Damped by 2/s: g (t / 2 - (1 - exp(-2 t)) / 4) in a second.
  EXPECT_NEAR(fall_of_jammed_block(-2e-4, 0.5, normal), 2.785, 0.05) << "no preload: free fall";
  const double weight = 1000 * 0.001 * g;
  EXPECT_GT(fall_of_jammed_block(1e-3, 0.5, normal), 0.5);
  EXPECT_LT(2 * 0.5 * normal, weight);
  double last = 1;
  for (const double squeeze : {8e-3, 8.1e-3, 1e-2}) {
    const double fall = fall_of_jammed_block(squeeze, 0.5, normal);
    EXPECT_GT(2 * 0.5 * normal, weight);
    EXPECT_LT(fall, 0.02);
    if (squeeze == 8.1e-3) {
      EXPECT_NEAR(fall, last, 1e-3) << "continuously";
    }
    last = fall;
  }
}

}  // namespace
}  // namespace souple
