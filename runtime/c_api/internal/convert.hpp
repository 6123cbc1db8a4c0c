// SPDX-License-Identifier: MIT
// Between the plain types of the C interface and those of the runtime; what is checked here is what the
// runtime takes for granted.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"
#include "runtime/c_api/souple/souple.h"
#include "runtime/world/settings.hpp"

namespace souple::c_api {

// Arrays of the ones are read and written as arrays of the others.
static_assert(sizeof(souple_vec3) == sizeof(Point) && alignof(souple_vec3) == alignof(Point));
static_assert(sizeof(souple_triangle) == sizeof(Triangle) && sizeof(Index) == sizeof(std::int32_t));

inline Point to_point(const souple_vec3& v) { return {v.x, v.y, v.z}; }
inline souple_vec3 from_point(const Point& p) { return {p[0], p[1], p[2]}; }
inline std::span<const Point> as_points(const souple_vec3* points, std::size_t count) {
  return {reinterpret_cast<const Point*>(points), count};
}

Pose to_pose(const souple_pose& pose);
souple_pose from_pose(const Pose& pose);
inline constexpr souple_pose identity_pose{{1, 0, 0, 0}, {0, 0, 0}};

bool is_finite(const souple_vec3& v);

/// NULL is empty. Issue api_argument_invalid: too long, or not UTF-8.
Result<std::string> to_text(const char* text, const char* name);

/// An array that may be NULL if it is empty. Issues: api_argument_missing, api_argument_invalid.
Status check_array(const void* array, std::size_t count, const char* name);

Result<std::vector<Keyframe>> to_path(const souple_keyframe* path, std::size_t count, const char* name);

/// Issue api_argument_invalid unless 0 <= number <= last.
Status check_number(std::int32_t number, std::int32_t last, const char* name);
template <class Enum>
Status to_enum(std::int32_t number, Enum last, const char* name, Enum& out) {
  auto status = check_number(number, static_cast<std::int32_t>(last), name);
  if (status) out = static_cast<Enum>(number);
  return status;
}
/// Of fields that later versions may use.
Status check_reserved(std::int32_t value);

}  // namespace souple::c_api
