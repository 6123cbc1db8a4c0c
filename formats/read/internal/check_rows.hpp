// SPDX-License-Identifier: MIT
// Checks of lists of indices and points that levels and the visual surface share.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "formats/core/limits.hpp"
#include "formats/core/mesh.hpp"
#include "formats/read/internal/issue_list.hpp"

namespace souple::checks {

/// One issue for every row that names something at or past `count`; `named` is what rows name.
template <class Rows>
void check_range(const Rows& rows, std::size_t count, const std::string& where, const char* kind,
                 const char* named, IssueList& issues) {
  const auto outside = [&](Index i) { return i < 0 || static_cast<std::size_t>(i) >= count; };
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto bad = std::ranges::find_if(rows[r], outside);
    if (bad == rows[r].end()) continue;
    issues.add(IssueCode::asset_index_out_of_range, where, [&] {
      return std::string(kind) + " " + std::to_string(r) + " names " + named + " " +
             std::to_string(*bad) + " of " + std::to_string(count);
    });
  }
}

/// Bounded and of sum 1: what carries a motion from four nodes to a point.
inline bool has_sound_weights(const std::array<double, 4>& weights) {
  double sum = 0;
  for (const double weight : weights) {
    // The negation also catches NaN.
    if (!(std::abs(weight) <= limits::embedding_weight)) return false;
    sum += weight;
  }
  return std::abs(sum - 1) <= limits::embedding_weight_sum;
}

inline void check_coordinates(const std::vector<Point>& points, const std::string& where,
                              const char* kind, IssueList& issues) {
  // The negation also catches NaN.
  const auto unusable = [](double x) { return !(std::abs(x) <= limits::coordinate_m); };
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::ranges::any_of(points[i], unusable))
      issues.add(IssueCode::asset_not_finite, where, [&] {
        return std::string(kind) + " " + std::to_string(i) + " is not finite or beyond 1e7 m";
      });
}

}  // namespace souple::checks
