// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/world/settings.hpp"

namespace souple {

/// Where a path of at least one keyframe is at a time: translation linear, rotation slerped, held
/// before the first keyframe and after the last.
Pose pose_at(const std::vector<Keyframe>& path, double time_s);

/// Unit quaternion, and a translation of at most 1e6 m.
Status check_pose(const Pose& pose, IssueCode code, const std::string& where);
/// Not empty, ascending finite times, sound poses.
Status check_path(const std::vector<Keyframe>& path, IssueCode code, const std::string& where);

}  // namespace souple
