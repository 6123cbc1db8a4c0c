// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/sizing.hpp"

#include <algorithm>
#include <cmath>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr double growth = 0.3;
constexpr double facet_per_cell = 0.9;
constexpr double distance_per_cell = 0.12;
/// Steps along sharp edges as long as the mean edge.
constexpr double step_per_cell = 1.2;
/// The mesher bounds the distance at the circumcentres of triangles; elsewhere it may be a little more.
constexpr double error_margin = 0.7;

Issue bad(const char* what) { return make_issue(IssueCode::usage_bad_value, what); }

bool positive(double value) { return value > 0 && std::isfinite(value); }

Status check_region(const BoxRegion& box) {
  for (std::size_t k = 0; k < 3; ++k)
    if (!(box.low[k] <= box.high[k]) || !std::isfinite(box.low[k]) || !std::isfinite(box.high[k]))
      return bad("a box of a local size must be finite, its low corner below its high one");
  return {};
}

Status check_region(const BallRegion& ball) {
  if (!positive(ball.radius_m) || !is_finite(ball.centre))
    return bad("a ball of a local size must be finite and its radius positive");
  return {};
}

Status check_region(const PatchRegion& patch) {
  if (!(patch.distance_m >= 0) || !std::isfinite(patch.distance_m))
    return bad("the distance around a patch must be finite and not negative");
  return check_triangle_mesh(patch.patch);
}

double distance_from_box(const Point& p, const BoxRegion& box) {
  Point off{};
  for (std::size_t k = 0; k < 3; ++k) off[k] = std::max({box.low[k] - p[k], p[k] - box.high[k], 0.0});
  return norm(off);
}

}  // namespace

Status check_sizes(const TetrahedralizeOptions& options) {
  for (const double value : {options.edge_length_m, options.max_error_m})
    if (!(value >= 0) || !std::isfinite(value))
      return bad("edge length and error must be finite and not negative");
  if (!(options.interior_coarsening >= 1 && options.interior_coarsening <= 100))
    return bad("the interior coarsening must lie between 1 and 100");
  for (const LocalSize& local : options.local_sizes) {
    if (!positive(local.edge_length_m)) return bad("a local edge length must be positive and finite");
    const Status region = std::visit([](const auto& r) { return check_region(r); }, local.region);
    if (!region) return region;
  }
  return {};
}

Sizing::Sizing(const UnitSurface& unit, const TetrahedralizeOptions& options)
    : frame_(unit.frame),
      coarsening_(options.interior_coarsening),
      max_error_(options.max_error_m / unit.frame.length_m()) {
  if (coarsening_ > 1) surface_ = std::make_shared<TriangleBvh>(unit.mesh);
  for (const LocalSize& size : options.local_sizes) {
    Local& local = local_.emplace_back(
        Local{size.edge_length_m / unit.frame.length_m() / edge_per_radius, size, {}});
    if (const auto* patch = std::get_if<PatchRegion>(&size.region))
      local.patch = std::make_shared<TriangleBvh>(patch->patch);
  }
}

double Sizing::Local::distance_m(const Point& x) const {
  if (const auto* box = std::get_if<BoxRegion>(&size.region)) return distance_from_box(x, *box);
  if (const auto* ball = std::get_if<BallRegion>(&size.region))
    return std::max(0.0, norm(subtract(x, ball->centre)) - ball->radius_m);
  const double away = std::sqrt(patch->closest(x).squared_distance);
  return std::max(0.0, away - std::get<PatchRegion>(size.region).distance_m);
}

double Sizing::cell_radius(const Point& unit_point, double base) const {
  double radius = base;
  if (surface_) {
    const double depth = std::sqrt(surface_->closest(unit_point).squared_distance);
    radius = std::min(coarsening_ * base, base + growth * depth);
  }
  if (local_.empty()) return radius;
  const Point x = frame_.to_metres(unit_point);
  for (const Local& local : local_)
    radius = std::min(radius, local.cell_radius + growth * local.distance_m(x) / frame_.length_m());
  return radius;
}

MesherSizes Sizing::sizes(double base) const {
  const auto times = [this, base](double factor) {
    return [this, base, factor](const Point& p) { return factor * cell_radius(p, base); };
  };
  MesherSizes sizes{times(1), times(facet_per_cell), times(distance_per_cell), times(step_per_cell)};
  if (max_error_ > 0)
    sizes.facet_distance = [this, base](const Point& p) {
      return std::min(distance_per_cell * cell_radius(p, base), error_margin * max_error_);
    };
  return sizes;
}

}  // namespace souple
