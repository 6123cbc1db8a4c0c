// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "formats/core/result.hpp"
#include "runtime/haptics/devices/recorded_path.hpp"
#include "runtime/haptics/tool.hpp"
#include "tools/scene/scene.hpp"

namespace souple {

/// The tool of a probe, and where the hand that holds it goes.
struct SceneTool {
  Tool tool;
  std::optional<RecordedPath> path;  ///< of devices that have one
};

/// Whether a probe holds the body of this name.
bool is_held(const Scene& scene, const std::string& body);

/// Adds the bodies that the probe holds to the world, where the scene has them at the start; `shapes`
/// are those of the jaws. Issues: those of read_hand_path and Tool.
Result<SceneTool> add_tool(World& world, const Scene& scene, const SceneProbe& probe,
                           const std::vector<RigidShape>& shapes);

}  // namespace souple
