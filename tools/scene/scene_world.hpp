// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/world/world.hpp"
#include "tools/scene/scene.hpp"

namespace souple {

/// What one asset file cost the scene.
struct AssetUse {
  std::filesystem::path file;
  std::uint64_t file_bytes = 0;
  std::uint64_t bytes_read = 0;          ///< metadata included
  std::uint64_t resident_bytes = 0;      ///< in memory, shared by its bodies
  std::vector<std::string> compliances;  ///< loaded ones; the others were not read
};

struct SceneWorld {
  World world;
  std::vector<BodyId> bodies;  ///< in the order of the scene
  std::vector<AssetUse> assets;
};

/// Loads every asset once, and of it only the compliances that the scene's time step and fixed sets
/// need. Issues: those of load_soft_body and World; fixed_set_invalid; scene_no_matching_compliance
/// (names what the asset has).
Result<SceneWorld> build_world(const Scene& scene);

}  // namespace souple
