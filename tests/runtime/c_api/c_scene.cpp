// SPDX-License-Identifier: MIT
#include "c_scene.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "formats/write/asset_writer.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"

namespace souple::test {
namespace {

// One vertex for every surface node, each bound to a tet that it is a corner of.
VisualMesh visual_of(const MeshLevel& level) {
  VisualMesh visual;
  const std::vector<Index> used = used_nodes(level.boundary);
  for (const Index node : used) {
    visual.surface.vertices.push_back(level.mesh.nodes[std::size_t(node)]);
    Embedding row;
    for (std::size_t t = 0; t < level.mesh.tets.size(); ++t)
      if (const auto corner = std::ranges::find(level.mesh.tets[t], node);
          corner != level.mesh.tets[t].end()) {
        row.tet = Index(t);
        row.weights = {};
        row.weights[std::size_t(corner - level.mesh.tets[t].begin())] = 1;
      }
    visual.embedding.push_back(row);
  }
  for (const Triangle& t : level.boundary) {
    Triangle shown{};
    for (std::size_t k = 0; k < 3; ++k)
      shown[k] = Index(std::ranges::lower_bound(used, t[k]) - used.begin());
    visual.surface.triangles.push_back(shown);
  }
  return visual;
}

Asset box_asset() {
  const TetMesh mesh = irregular_box_mesh({3, 3, 3}, {-0.05, -0.05, 0}, {0.1, 0.1, 0.1}, 0.3);
  FixedSet bottom{"bottom", {}}, edge{"käntchen", {0, 1}};
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node)
    if (mesh.nodes[node][2] < 1e-9) bottom.nodes.push_back(Index(node));
  const Material material = material_of(1e4, 0.4, 1000, 0.1, 0.01);
  Asset asset = make_asset(mesh, material, 0.01, {bottom, edge});
  Asset held = make_asset(mesh, material, 0.01, {bottom}, "bottom");
  asset.compliances[0].header.name = "free";
  held.compliances[0].header.name = "held";
  asset.compliances.push_back(std::move(held.compliances[0]));
  asset.visual = visual_of(asset.levels[0]);
  asset.provenance = {"test", "", "box", "00000000000000000000000000000000"};
  return asset;
}

struct TemporaryAsset {
  TemporaryAsset() {
    auto made = write_asset_memory(box_asset());
    if (made) bytes = std::move(*made);
    file = std::filesystem::temp_directory_path() /
           ("souple c api bäcker " + std::to_string(::getpid()) + ".souple");
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  }
  ~TemporaryAsset() {
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
  }
  std::vector<std::byte> bytes;
  std::filesystem::path file;
};

const TemporaryAsset& temporary() {
  static const TemporaryAsset made;
  return made;
}

}  // namespace

const std::filesystem::path& asset_file() { return temporary().file; }
const std::vector<std::byte>& asset_bytes() { return temporary().bytes; }

AssetHandle open_asset() {
  souple_asset* asset = nullptr;
  EXPECT_EQ(souple_asset_open_file(asset_file().c_str(), nullptr, &asset), SOUPLE_OK)
      << souple_last_error_what();
  return AssetHandle(asset);
}

WorldHandle make_c_world(const souple_world_settings* settings) {
  souple_world* world = nullptr;
  EXPECT_EQ(souple_world_create(settings, &world), SOUPLE_OK) << souple_last_error_what();
  return WorldHandle(world);
}

souple_body add_c_soft(souple_world* world, const souple_asset* asset, double height_m,
                       const char* fixed_set) {
  auto description = initialised(souple_soft_body_description_init);
  description.name = "soft";
  description.pose.translation_m.z = height_m;
  description.fixed_set = fixed_set;
  souple_body body = SOUPLE_NO_BODY;
  EXPECT_EQ(souple_world_add_soft_body(world, asset, &description, &body), SOUPLE_OK)
      << souple_last_error_what();
  return body;
}

souple_body add_c_rigid(souple_world* world, int shape, double height_m, int motion) {
  auto description = initialised(souple_rigid_body_description_init);
  description.name = "rigid";
  description.shape = shape;
  description.motion = motion;
  description.radius_m = 0.03;
  description.half_length_m = 0.02;
  description.half_extents_m = {0.03, 0.03, 0.03};
  description.pose.translation_m.z = height_m;
  souple_body body = SOUPLE_NO_BODY;
  EXPECT_EQ(souple_world_add_rigid_body(world, &description, &body), SOUPLE_OK)
      << souple_last_error_what();
  return body;
}

void step_c(souple_world* world, int count) {
  for (int k = 0; k < count; ++k)
    ASSERT_EQ(souple_world_step(world, nullptr), SOUPLE_OK) << souple_last_error_what();
}

std::vector<souple_vec3> positions_of(const souple_world* world, souple_body body) {
  std::size_t count = 0;
  EXPECT_EQ(souple_world_positions(world, body, nullptr, 0, &count), SOUPLE_OK);
  std::vector<souple_vec3> positions(count);
  EXPECT_EQ(souple_world_positions(world, body, positions.data(), count, nullptr), SOUPLE_OK);
  return positions;
}

std::vector<std::byte> snapshot_of(const souple_world* world) {
  std::size_t size = 0;
  EXPECT_EQ(souple_world_snapshot(world, nullptr, 0, &size), SOUPLE_OK);
  std::vector<std::byte> bytes(size);
  EXPECT_EQ(souple_world_snapshot(world, bytes.data(), size, &size), SOUPLE_OK);
  return bytes;
}

}  // namespace souple::test
