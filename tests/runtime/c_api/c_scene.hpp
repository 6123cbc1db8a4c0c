// SPDX-License-Identifier: MIT
// An asset of a box, in a file and in memory, and small scenes with it through the C interface.
#pragma once
#include <souple/souple.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace souple::test {

/// A box of 0.1 m in irregular tets with a compliance for 0.01 s without and with the fixed set
/// "bottom", a surface to be shown, and names beyond ASCII. Made once; the file is removed at exit.
const std::filesystem::path& asset_file();
const std::vector<std::byte>& asset_bytes();

struct Release {
  void operator()(souple_asset* asset) const { souple_asset_release(asset); }
  void operator()(souple_world* world) const { souple_world_destroy(world); }
  void operator()(souple_rigid_mesh* mesh) const { souple_rigid_mesh_release(mesh); }
  void operator()(souple_haptic_channel* channel) const { souple_haptic_channel_destroy(channel); }
};
using AssetHandle = std::unique_ptr<souple_asset, Release>;
using WorldHandle = std::unique_ptr<souple_world, Release>;
using ChannelHandle = std::unique_ptr<souple_haptic_channel, Release>;
using MeshHandle = std::unique_ptr<souple_rigid_mesh, Release>;

/// A filled struct: `auto d = initialised(souple_world_settings_init);`
template <class T>
T initialised(souple_status (*init)(T*, std::size_t)) {
  T made;
  init(&made, sizeof made);
  return made;
}

/// All of them fail the test that calls them if the library refuses.
AssetHandle open_asset();
WorldHandle make_c_world(const souple_world_settings* settings = nullptr);
souple_body add_c_soft(souple_world* world, const souple_asset* asset, double height_m,
                       const char* fixed_set = nullptr);
souple_body add_c_rigid(souple_world* world, int shape, double height_m,
                        int motion = SOUPLE_MOTION_FIXED);
void step_c(souple_world* world, int count);
std::vector<souple_vec3> positions_of(const souple_world* world, souple_body body);
std::vector<std::byte> snapshot_of(const souple_world* world);

}  // namespace souple::test
