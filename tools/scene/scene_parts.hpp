// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of a scene that several kinds of bodies have. Internal to the parser.
#pragma once
#include <array>
#include <vector>

#include "tools/exchange/strict_toml.hpp"
#include "tools/scene/scene.hpp"

namespace souple {

/// `position` and `rotation` of the table.
Pose parse_pose(TomlTable& table);
/// `keyframes` of poses, or else the one pose of the table.
std::vector<Keyframe> parse_path(TomlTable& entry);
/// A table of `[[body]]`; `number` names one without a name.
SceneBody parse_body(TomlTable& entry, std::size_t number);
/// `[[pair]]`, `[[joint]]` and `[[grab]]`; the bodies of the scene are known.
void parse_constraints(TomlTable& root, Scene& scene);
/// `[[probe]]`; the bodies of the scene are known.
void parse_probes(TomlTable& root, Scene& scene);

/// Of the keyframe, after `last` of the one before.
double parse_time(TomlTable& frame, double last);
void check_keyframe_count(TomlTable& entry, std::size_t count);
/// `rotation` of the table, normalised: {axis, angle_deg} or {quaternion = [w, x, y, z]}.
std::array<double, 4> parse_rotation(TomlTable rotation);
/// `[[body.driven]]`.
std::vector<DrivenSet> parse_driven(TomlTable& entry);
/// `[[body.load]]`.
std::vector<SceneLoad> parse_loads(TomlTable& entry);

}  // namespace souple
