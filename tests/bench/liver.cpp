// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/liver.hpp"

#include <cmath>

#include "formats/write/asset_writer.hpp"
#include "runtime/load/load_soft_body.hpp"

namespace souple::bench {
namespace {

class SilentProgress final : public ProgressSink {
 public:
  void stage(std::string_view) override {}
  void fraction(double) override {}
};

}  // namespace

Recipe liver_recipe(std::int64_t tets, std::int64_t levels) {
  Recipe recipe;
  recipe.surface.file = data_folder() / "surfaces" / "liver-smooth.obj";
  recipe.surface.size_m = 0.2;
  recipe.mesh.tets = tets;
  recipe.mesh.levels = levels;
  return recipe;
}

BakeOutcome bake_or_exit(const Recipe& recipe) {
  SilentProgress silent;
  return value_or_exit(bake_asset(recipe, "souple bench", silent));
}

std::shared_ptr<const SoftBodyAsset> baked_liver(std::int64_t tets, std::int64_t levels,
                                                 double tolerance) {
  Recipe recipe = liver_recipe(tets, levels);
  recipe.compliances.front().tolerance = tolerance;
  const auto bytes = value_or_exit(write_asset_memory(bake_or_exit(recipe).asset));
  auto reader = value_or_exit(AssetReader::open_memory(bytes));
  return value_or_exit(load_soft_body(reader));
}

DropScene make_drop(std::shared_ptr<const SoftBodyAsset> liver, const WorldSettings& settings) {
  DropScene scene{value_or_exit(World::create(settings)), {}};
  SoftBodyDescription body;
  body.name = "liver";
  const double half = std::sqrt(0.5);  // a quarter turn about x: its hollow side down
  body.pose = {{half, half, 0, 0}, {0.046, 0.017, 0.1}};
  scene.body = value_or_exit(scene.world.add_soft_body(std::move(liver), body));
  RigidBodyDescription floor, ball;
  floor.name = "floor";
  floor.path = {{0, {}}};
  ball.name = "ball";
  ball.shape.kind = RigidShapeKind::sphere;
  ball.shape.radius_m = 0.04;
  ball.path = {{0, Pose{{1, 0, 0, 0}, {0.04, 0, 0.04}}}};
  value_or_exit(scene.world.add_rigid_body(floor));
  value_or_exit(scene.world.add_rigid_body(ball));
  return scene;
}

}  // namespace souple::bench
