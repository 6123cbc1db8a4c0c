// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/process/import_options.hpp"

#include <cmath>

#include "tools/process/length_unit.hpp"

namespace souple {
namespace {

constexpr double smallest_size_m = 1e-9, largest_size_m = 1e15;
constexpr double longest_time_s = 24 * 3600;
constexpr std::size_t least_memory_bytes = std::size_t{1} << 20;

}  // namespace

Status check_import_options(const std::string& unit, double size_m, double time_limit_s,
                            std::size_t memory_limit_bytes) {
  const auto bad = [](std::string what) {
    return make_issue(IssueCode::usage_bad_value, std::move(what));
  };
  if (!metres_per_unit(unit))
    return bad("unit '" + unit.substr(0, 20) + "' is not one of " + std::string(length_unit_names));
  if (!std::isfinite(size_m) || size_m < 0)
    return bad("the target size must be positive and finite, in metres");
  if (!(time_limit_s > 0) || time_limit_s > longest_time_s)
    return bad("the time limit must lie in (0, 86400] s");
  if (memory_limit_bytes < least_memory_bytes) return bad("the memory limit is below 1 MiB");
  return {};
}

Result<double> import_scale(double longest_side, const std::string& unit, double size_m,
                            IssueCode no_extent) {
  if (!(longest_side > 0)) return make_issue(no_extent, "all points lie in one point");
  const double scale = size_m > 0 ? size_m / longest_side : metres_per_unit(unit).value_or(1);
  const double scaled_m = longest_side * scale;
  if (!(scaled_m >= smallest_size_m && scaled_m <= largest_size_m) || !std::isfinite(scale))
    return make_issue(no_extent, "the longest side would be " + std::to_string(scaled_m) + " m");
  return scale;
}

}  // namespace souple
