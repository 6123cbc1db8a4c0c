// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of a scene that several kinds of bodies have. Internal to the parser.
#pragma once
#include <vector>

#include "tools/exchange/strict_toml.hpp"
#include "tools/scene/scene.hpp"

namespace souple {

/// `position` and `rotation` of the table.
Pose parse_pose(TomlTable& table);
/// `keyframes` of poses, or else the one pose of the table.
std::vector<Keyframe> parse_path(TomlTable& entry);
/// `[[body.driven]]`.
std::vector<DrivenSet> parse_driven(TomlTable& entry);
/// `[[body.load]]`.
std::vector<SceneLoad> parse_loads(TomlTable& entry);

}  // namespace souple
