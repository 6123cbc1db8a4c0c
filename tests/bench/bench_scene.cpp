// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/bench_scene.hpp"

#include <cstdlib>

#include "runtime/world/soft_body_asset.hpp"
#include "tools/recipe/bake.hpp"
#include "tools/recipe/rigid_surface.hpp"

namespace souple::bench {
namespace {
namespace fs = std::filesystem;

class SilentProgress final : public ProgressSink {
 public:
  void stage(std::string_view) override {}
  void fraction(double) override {}
};

fs::path scratch_folder() {
  const char* folder = std::getenv("BENCH_TMP");
  const fs::path path =
      (folder != nullptr ? fs::path(folder) : fs::temp_directory_path()) / "souple-scenes";
  fs::create_directories(path);
  return path;
}

fs::path baked(const std::string& name) {
  const fs::path file = scratch_folder() / (name + ".souple");
  if (fs::exists(file)) return file;
  const Recipe recipe = value_or_exit(read_recipe(fs::path("assets/recipes") / (name + ".toml")));
  SilentProgress silent;
  BakeOutcome outcome = value_or_exit(bake_asset(recipe, "souple bench", silent));
  if (auto status = write_baked_asset(outcome, file, silent); !status) exit_with(status.issue());
  return file;
}

}  // namespace

Scene bench_scene(const std::string& name) {
  Scene scene = value_or_exit(read_scene(fs::path("assets/scenes") / (name + ".toml")));
  for (SceneBody& body : scene.bodies)
    if (auto* soft = std::get_if<SceneSoftBody>(&body))
      soft->asset = baked(soft->asset.stem().string());
  return scene;
}

SceneWorld build_or_exit(const Scene& scene) {
  return value_or_exit(build_world(scene, [](const RigidMeshFile& mesh) {
    return read_rigid_surface(mesh.file, mesh.scale, mesh.size_m);
  }));
}

StepReport step_or_exit(const Scene& scene, SceneWorld& built) {
  if (auto status = drive_grabs(scene, built); !status) exit_with(status.issue());
  return value_or_exit(built.world.step());
}

double mean_edge_m(const SoftBodyAsset& asset) {
  const auto rest = asset.model().rest_positions();
  double sum = 0;
  std::size_t count = 0;
  for (const Triangle& t : asset.surface().triangles())
    for (std::size_t k = 0; k < 3; ++k, ++count)
      sum += (as_vec3(rest[std::size_t(t[k])]) - as_vec3(rest[std::size_t(t[(k + 1) % 3])])).norm();
  return sum / double(count);
}

}  // namespace souple::bench
