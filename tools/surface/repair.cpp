// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/repair.hpp"

#include <cmath>
#include <exception>
#include <optional>
#include <string>
#include <utility>

#include "tools/geometry/surface_samples.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/surface/mend.hpp"
#include "tools/surface/unit_soup.hpp"
#include "tools/surface/wrap_surface.hpp"

namespace souple {
namespace {

/// Of the diagonal.
constexpr double default_max_error = 0.01;

double diagonal_of(const TriangleMesh& mesh) {
  const Box box = bounding_box(mesh.vertices);
  return norm(subtract(box.high, box.low));
}

Issue hopeless(const SurfaceTriage& triage) {
  return make_issue(IssueCode::surface_hopeless,
                    triage.findings.empty() ? "nothing is enclosed" : triage.findings.front());
}

void add_action(RepairReport& report, std::string name, std::size_t count, std::string detail) {
  if (count > 0) report.actions.push_back({std::move(name), count, std::move(detail)});
}

/// Checks and measures the result by means of its own.
Result<RepairedSurface> finish(const TriangleMesh& surface, const TriangleMesh& result, bool has_moved,
                               RepairReport report) {
  Result<OrientedSurface> oriented = orient_closed_surface(result);
  if (!oriented) return oriented.issue();
  RepairedSurface repaired;
  repaired.mesh = std::move(oriented->mesh);
  report.orient = oriented->report;
  Result<SurfaceTriage> after = triage_surface(repaired.mesh);
  if (!after) return after.issue();
  report.after = std::move(*after);
  if (has_moved) report.moved = two_sided_distance(surface, repaired.mesh);
  repaired.report = std::move(report);
  return repaired;
}

std::string describe(const WrapTrial& trial, double length_m) {
  const auto metres = [&](double x) { return std::to_string(x * length_m); };
  return "triangles; alpha " + metres(trial.alpha) + " m, offset " + metres(trial.offset) + " m";
}

Result<RepairedSurface> wrap(const TriangleMesh& surface, const UnitSoup& unit, const Mended& mended,
                             const RepairOptions& options, RepairReport report) {
  // Lids on the holes keep a fine wrap out of them.
  const bool has_lids = mended.closed && mended.lost_share == 0;
  const TriangleMesh& base = has_lids ? mended.mesh : unit.mesh();
  const double volume = mended.closed ? std::abs(signed_volume(mended.mesh)) : 0;
  const double max_error_m =
      options.max_error_m > 0 ? options.max_error_m : default_max_error * diagonal_of(surface);
  Result<Wrapped> wrapped = wrap_surface(base, max_error_m / unit.length_m(), has_lids, volume);
  if (!wrapped) return wrapped.issue();
  report.wrapped = true;
  add_action(report, "wrap", wrapped->mesh.triangles.size(), describe(wrapped->taken, unit.length_m()));
  return finish(surface, unit.in_metres(wrapped->mesh), true, std::move(report));
}

/// What mending gave, if that is a solid. Vertices that were not moved get their exact coordinates
/// back, unless that folds something over which is sound on the unit grid.
std::optional<Result<RepairedSurface>> take_mended(const TriangleMesh& surface, const UnitSoup& unit,
                                                   const Mended& mended, const RepairReport& report) {
  if (!mended.closed) return std::nullopt;
  RepairReport mine = report;
  mine.actions.insert(mine.actions.end(), mended.actions.begin(), mended.actions.end());
  const bool has_moved = !mended.actions.empty();
  auto exact = finish(surface, unit.in_metres(mended.mesh), has_moved, mine);
  if (exact && exact->report.after.self_intersection_count <= mended.cuts) return exact;
  auto rounded = finish(surface, unit.on_grid_in_metres(mended.mesh), has_moved, std::move(mine));
  return rounded ? rounded : exact;
}

Result<RepairedSurface> mend_or_wrap(const TriangleMesh& surface, const RepairOptions& options,
                                     RepairReport report) {
  const UnitSoup unit(surface);
  add_action(report, "merge vertices", unit.merged_vertex_count(),
             "vertices at the place of another, or unused");
  add_action(report, "drop triangles", unit.dropped_triangle_count(),
             "triangles without area or repeated");
  const Mended mended = mend_surface(unit.mesh());
  if (options.mode != RepairMode::wrap) {
    auto taken = take_mended(surface, unit, mended, report);
    const bool is_clean = taken && taken->ok() && !mended.failure;
    if (is_clean) return std::move(*taken);
    if (options.mode == RepairMode::mend) {
      if (taken) return std::move(*taken);
      return *mended.failure;
    }
    Result<RepairedSurface> wrapped = wrap(surface, unit, mended, options, report);
    if (!wrapped && taken && taken->ok()) return std::move(*taken);
    return wrapped;
  }
  return wrap(surface, unit, mended, options, std::move(report));
}

Result<RepairedSurface> repair(const TriangleMesh& surface, const RepairOptions& options) {
  if (!std::isfinite(options.max_error_m) || options.max_error_m < 0)
    return make_issue(IssueCode::usage_bad_value, "the largest error must be finite and not negative");
  Result<SurfaceTriage> before = triage_surface(surface);
  if (!before) return before.issue();
  RepairReport report;
  report.before = std::move(*before);
  if (options.mode == RepairMode::off) return finish(surface, surface, false, std::move(report));
  if (report.before.grade == SurfaceGrade::hopeless) return hopeless(report.before);
  return mend_or_wrap(surface, options, std::move(report));
}

}  // namespace

Result<RepairedSurface> repair_surface(const TriangleMesh& surface, const RepairOptions& options) try {
  return repair(surface, options);
} catch (const std::exception& e) {
  return make_issue(IssueCode::surface_wrap_failed, std::string("the repair stopped: ") + e.what());
}

}  // namespace souple
