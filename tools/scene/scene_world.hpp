// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/world/world.hpp"
#include "tools/scene/scene.hpp"
#include "tools/scene/scene_tools.hpp"

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
  std::vector<RigidShape> shapes{};            ///< of the bodies; of a soft one nothing
  std::vector<std::optional<GrabId>> grabs{};  ///< in the order of the scene; nothing: released
  std::vector<SceneTool> tools{};              ///< of the probes
};

/// Reads the surface of a rigid body, in metres: which files can be read is the application's to know.
using MeshLoader = std::function<Result<TriangleMesh>(const RigidMeshFile&)>;

/// Loads every asset once, and of it only the compliances that the scene's time step and fixed sets
/// need. Issues: those of load_soft_body and World; fixed_set_invalid; scene_no_matching_compliance
/// (names what the asset has); those of `load_mesh`, unsupported_feature without one; those of
/// add_tool.
Result<SceneWorld> build_world(const Scene& scene, const MeshLoader& load_mesh = {});

/// Tells the grabs of the scene where to be at the end of the next step, and releases those whose time
/// has come. To be called before every step.
Status drive_grabs(const Scene& scene, SceneWorld& built);

}  // namespace souple
