// SPDX-License-Identifier: GPL-3.0-or-later
// Arithmetic on Point for the meshing tools.
#pragma once
#include <algorithm>
#include <cmath>

#include "formats/core/mesh.hpp"

namespace souple {

inline Point add(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Point subtract(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Point scaled(const Point& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
/// a + s b
inline Point add_scaled(const Point& a, double s, const Point& b) {
  return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
}
inline double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double squared_norm(const Point& a) { return dot(a, a); }
inline double norm(const Point& a) { return std::sqrt(dot(a, a)); }
inline bool is_finite(const Point& a) {
  return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]);
}

}  // namespace souple
