// SPDX-License-Identifier: MIT
#include "runtime/c_api/internal/convert.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include "formats/core/names.hpp"
#include "runtime/c_api/internal/refusal.hpp"

namespace souple::c_api {
namespace {

constexpr std::size_t longest_text = 4095;  // bytes

}  // namespace

Pose to_pose(const souple_pose& pose) {
  const double* q = pose.rotation_wxyz;
  return {{q[0], q[1], q[2], q[3]}, to_point(pose.translation_m)};
}

souple_pose from_pose(const Pose& pose) {
  const auto& q = pose.rotation;
  return {{q[0], q[1], q[2], q[3]}, from_point(pose.translation)};
}

bool is_finite(const souple_vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Result<std::string> to_text(const char* text, const char* name) {
  if (!text) return std::string();
  const std::size_t length = ::strnlen(text, longest_text + 1);
  if (length > longest_text)
    return invalid("the text is longer than " + std::to_string(longest_text) + " bytes", name);
  std::string copy(text, length);
  if (!is_valid_text(copy)) return invalid("the text is not UTF-8", name);
  return copy;
}

Status check_array(const void* array, std::size_t count, const char* name) {
  if (count == 0) return {};
  if (auto status = need({{array, name}}); !status) return status;
  if (count <= std::size_t(std::numeric_limits<Index>::max())) return {};
  return invalid(std::to_string(count) + " entries are more than can be", name);
}

Result<std::vector<Keyframe>> to_path(const souple_keyframe* path, std::size_t count,
                                      const char* name) {
  if (auto status = check_array(path, count, name); !status) return status.issue();
  std::vector<Keyframe> keyframes(count);
  for (std::size_t k = 0; k < count; ++k) keyframes[k] = {path[k].time_s, to_pose(path[k].pose)};
  return keyframes;
}

Status check_number(std::int32_t number, std::int32_t last, const char* name) {
  if (number >= 0 && number <= last) return {};
  return invalid(std::to_string(number) + " is outside [0, " + std::to_string(last) + "]", name);
}

Status check_reserved(std::int32_t value) {
  if (value == 0) return {};
  return invalid("reserved fields are 0", "reserved");
}

}  // namespace souple::c_api
