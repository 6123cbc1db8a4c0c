// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/haptic_scene.hpp"

#include <algorithm>
#include <cmath>

#include "formats/write/asset_writer.hpp"
#include "runtime/collision/rigid_mesh.hpp"
#include "runtime/load/load_soft_body.hpp"

namespace souple::bench {
namespace {

// The lobe's middle, half of the gap between the closed jaws, and the handle's distance from it, m.
const Vec3 lobe(0.015, 0.122, 0.024);
constexpr double half_gap = 0.024, arm = 0.12;
constexpr double half_length = 0.035, half_width = 0.04, thickness = 0.006, tooth = 0.0005;
constexpr double wide_open = 0.45;

// A plate in its own frame: teeth at z = 0, its back at z = thickness; closed, wound outward.
TriangleMesh toothed_plate(int teeth) {
  TriangleMesh mesh;
  const int across = 2 * teeth, along = 8;
  const auto front = [&](int i, int j) { return Index(i * (along + 1) + j); };
  const auto count = Index((across + 1) * (along + 1));
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i <= across; ++i)
      for (int j = 0; j <= along; ++j) {
        const double x = half_length * (2.0 * i / across - 1), y = half_width * (2.0 * j / along - 1);
        mesh.vertices.push_back({x, y, side == 1 ? thickness : i % 2 == 1 ? tooth : 0.0});
      }
  const auto quad = [&](Index a, Index b, Index c, Index d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (int i = 0; i < across; ++i)
    for (int j = 0; j < along; ++j) {
      quad(front(i, j), front(i, j + 1), front(i + 1, j + 1), front(i + 1, j));
      quad(count + front(i, j), count + front(i + 1, j), count + front(i + 1, j + 1),
           count + front(i, j + 1));
    }
  for (int i = 0; i < across; ++i) {
    quad(front(i, 0), front(i + 1, 0), count + front(i + 1, 0), count + front(i, 0));
    quad(front(i, along), count + front(i, along), count + front(i + 1, along), front(i + 1, along));
  }
  for (int j = 0; j < along; ++j) {
    quad(front(0, j), count + front(0, j), count + front(0, j + 1), front(0, j + 1));
    quad(front(across, j), front(across, j + 1), count + front(across, j + 1),
         count + front(across, j));
  }
  return mesh;
}

ToolDescription forceps(const GripSettings& settings) {
  ToolDescription tool;
  tool.name = "forceps";
  tool.pose.translation = as_point(lobe + Vec3(arm, 0, 0));
  tool.opening_rad = wide_open;
  RigidShape plate;
  plate.kind = RigidShapeKind::mesh;
  plate.mesh =
      std::make_shared<const RigidMesh>(value_or_exit(RigidMesh::make(toothed_plate(settings.teeth))));
  for (const double side : {1.0, -1.0}) {
    JawDescription jaw;
    jaw.shape = plate;
    jaw.hinge.translation = {0, 0, side * half_gap};
    // The lower jaw is the upper one turned over about x.
    jaw.mount.rotation = side > 0 ? std::array{1.0, 0.0, 0.0, 0.0} : std::array{0.0, 1.0, 0.0, 0.0};
    jaw.mount.translation = {-arm, 0, 0};
    jaw.axis = {0, 1, 0};
    jaw.turn_per_opening = 0.5 * side;
    jaw.coupling.stiffness_n_m = 2000;
    jaw.coupling.turn_stiffness_nm_rad = 5;
    jaw.coupling.look_ahead_m = settings.look_ahead_m;
    tool.jaws.push_back(jaw);
  }
  return tool;
}

World make_world(const GripSettings& settings) {
  WorldSettings world;
  world.time_step_s = settings.time_step_s;
  world.friction = 0.6;
  world.measure_laws = false;
  world.contact_solver.tolerance = 1e-4;
  return value_or_exit(World::create(world));
}

}  // namespace

std::shared_ptr<const SoftBodyAsset> held_liver(std::int64_t tets, double time_step_s) {
  Recipe recipe = liver_recipe(tets, 1);
  recipe.fixed.push_back({"held", BoxSelection{{-1, -1, -1}, {-0.12, 1, 1}}});
  recipe.compliances.front().time_step_s = time_step_s;
  recipe.compliances.front().fixed = "held";
  const auto bytes = value_or_exit(write_asset_memory(bake_or_exit(recipe).asset));
  auto reader = value_or_exit(AssetReader::open_memory(bytes));
  return value_or_exit(load_soft_body(reader));
}

GripScene GripScene::make(std::shared_ptr<const SoftBodyAsset> liver, const GripSettings& settings) {
  World world = make_world(settings);
  SoftBodyDescription body;
  body.name = "liver";
  body.fixed_set = "held";
  const BodyId id = value_or_exit(world.add_soft_body(std::move(liver), body));
  Tool tool = value_or_exit(Tool::create(world, forceps(settings)));
  HapticChannel channel = value_or_exit(HapticChannel::create(std::move(tool), settings.haptics));
  return {std::move(world), std::move(channel), id, settings.time_step_s};
}

Wrench GripScene::tick(double passed_s, const DeviceSample& sample) {
  time_s += passed_s;
  DeviceSample now = sample;
  now.time_s = time_s;
  return channel.tick(now);
}

void GripScene::physics_step() {
  if (auto status = channel.begin_step(world); !status) exit_with(status.issue());
  value_or_exit(world.step());
  if (auto status = channel.publish(world); !status) exit_with(status.issue());
}

void GripScene::grip() {
  constexpr int steps = 100, ticks = 4;
  for (int k = 0; k <= steps; ++k) {
    DeviceSample hand = probing_hand(0, 0);
    hand.opening_rad += (wide_open - hand.opening_rad) * (1 - double(k) / steps);
    for (int t = 0; t < ticks; ++t) tick(step_s / ticks, hand);
    physics_step();
  }
}

DeviceSample probing_hand(double time_s, double peak_speed_m_s) {
  // Three frequencies that do not meet; amplitudes so that the speed peaks where it is asked for.
  const double rate = 12, amplitude = peak_speed_m_s / rate;
  const double begin = std::min(1.0, time_s / 0.2);
  DeviceSample hand;
  const Vec3 way = begin * amplitude *
                   Vec3(0.5 * std::sin(rate * time_s), 0.4 * std::sin(0.83 * rate * time_s),
                        0.75 * std::sin(0.71 * rate * time_s));
  hand.pose.translation = as_point(lobe + Vec3(arm, 0, 0) + way);
  const double turn = begin * 0.5 * amplitude / arm * std::sin(0.61 * rate * time_s);
  hand.pose.rotation = {std::cos(turn / 2), std::sin(turn / 2), 0, 0};
  hand.opening_rad = begin * amplitude * std::sin(0.47 * rate * time_s);
  return hand;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto place = std::min(values.size() - 1, std::size_t(share * double(values.size())));
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(place), values.end());
  return values[place];
}

}  // namespace souple::bench
