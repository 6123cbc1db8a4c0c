// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/decimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/surface_samples.hpp"
#include "tools/geometry/unit_frame.hpp"
#include "tools/surface/clear_intersections.hpp"
#include "tools/surface/collapse.hpp"
#include "tools/surface/guarded_step.hpp"
#include "tools/surface/self_intersections.hpp"
#include "tools/surface/surface_difference.hpp"

namespace souple {
namespace {

constexpr std::size_t least_faces = 4;
/// Times the target, tried in this order until the result is clean.
constexpr std::array<double, 6> retreats{1, 1.1, 1.25, 1.5, 2, 3};
/// Halvings in the search for the count that an error bound allows; the count is then within 2 %.
constexpr int most_halvings = 9;
constexpr double fine_enough = 1.02;

/// Mending after a collapse may move the surface by this much more, in units.
constexpr double most_mending = 0.01;

/// Of the volume; beyond it the collapse goes less far.
constexpr double most_volume_change = 0.01;
/// More pairs than this say that the collapse went too far; to mend them would take long.
constexpr std::size_t most_mended_pairs = 60;

struct Collapsed {
  TriangleMesh mesh;  ///< at unit size
  std::size_t cuts = 0;
  bool is_mended = false;
  std::vector<std::string> notes;
};

struct Input {
  TriangleMesh unit;
  std::size_t cuts = 0;
};

/// One collapse, mended where it cuts itself; nothing if it is not sound.
std::optional<Collapsed> collapse_once(const Input& input, std::size_t faces, CollapseRule rule) {
  Result<MendStep> step = run_guarded([&] { return collapse_edges(input.unit, faces, rule); });
  if (!step || !check_closed_oriented_manifold(step->mesh).ok() || !(signed_volume(step->mesh) > 0))
    return std::nullopt;
  Collapsed result{std::move(step->mesh), 0, false, {}};
  result.cuts = find_self_intersections(result.mesh).pairs.size();
  if (result.cuts <= input.cuts || result.cuts > input.cuts + most_mended_pairs) return result;
  std::size_t removed = 0;
  TriangleMesh mended = clear_intersections(result.mesh, removed);
  if (removed == 0 || distance_where_different(result.mesh, mended) > most_mending) return result;
  result.mesh = std::move(mended);
  result.cuts -= removed;
  result.is_mended = true;
  result.notes.push_back("self-intersections mended after the collapse: " + std::to_string(removed) +
                         " pairs");
  return result;
}

bool is_clean(const Collapsed& result, const Input& input, std::size_t faces) {
  return result.cuts <= input.cuts && result.mesh.triangles.size() <= faces;
}

std::string rule_note() { return "Garland-Heckbert: Lindstrom-Turk left self-intersections"; }

double volume_change(const Input& input, const Collapsed& result) {
  const double before = signed_volume(input.unit);
  return std::abs(signed_volume(result.mesh) - before) / before;
}

/// Lindstrom-Turk if that needed no mending, else whichever rule keeps the volume better.
std::optional<Collapsed> collapse_by_either_rule(const Input& input, std::size_t faces,
                                                 std::size_t& reached) {
  std::optional<Collapsed> best;
  for (const CollapseRule rule : {CollapseRule::lindstrom_turk, CollapseRule::garland_heckbert}) {
    std::optional<Collapsed> result = collapse_once(input, faces, rule);
    if (!result) continue;
    reached = std::min(reached, result->mesh.triangles.size());
    if (!is_clean(*result, input, faces)) continue;
    if (rule == CollapseRule::garland_heckbert)
      result->notes.push_back(rule_note());
    else if (!result->is_mended)
      return result;
    if (!best || volume_change(input, *result) < volume_change(input, *best)) best = std::move(result);
  }
  return best;
}

/// At the target, then ever less far until the volume is kept too; failing that, what kept it best.
/// `reached` is the least count seen, for the message.
std::optional<Collapsed> collapse_cleanly(const Input& input, std::size_t target,
                                          std::size_t& reached) {
  std::optional<Collapsed> best;
  for (const double retreat : retreats) {
    const auto faces = static_cast<std::size_t>(std::floor(static_cast<double>(target) * retreat));
    std::optional<Collapsed> result = collapse_by_either_rule(input, faces, reached);
    if (!result) continue;
    if (!best || volume_change(input, *result) < volume_change(input, *best)) best = std::move(result);
    if (volume_change(input, *best) <= most_volume_change) break;
  }
  if (best && best->mesh.triangles.size() > target)
    best->notes.push_back("the target of " + std::to_string(target) +
                          " faces is missed: with fewer the surface would cut itself or lose volume");
  return best;
}

double distance(const Input& input, const TriangleMesh& mesh) {
  return two_sided_distance(input.unit, mesh).hausdorff();
}

/// The least count whose surface stays within `max_error`, by bisection; the input itself if none does.
Collapsed collapse_within(const Input& input, std::size_t least, double max_error) {
  Collapsed best{input.unit, input.cuts, false, {}};
  auto low = static_cast<double>(least), high = static_cast<double>(input.unit.triangles.size());
  for (int i = 0; i < most_halvings && high > low * fine_enough; ++i) {
    const double middle = std::sqrt(low * high);
    std::optional<Collapsed> result =
        collapse_once(input, static_cast<std::size_t>(middle), CollapseRule::lindstrom_turk);
    if (result && result->cuts <= input.cuts && distance(input, result->mesh) <= max_error) {
      high = middle;
      if (result->mesh.triangles.size() < best.mesh.triangles.size()) best = std::move(*result);
    } else {
      low = middle;
    }
  }
  return best;
}

Result<Collapsed> collapse(const Input& input, const DecimateOptions& options, double max_error) {
  const std::size_t target = options.target_face_count;
  if (target > 0 && max_error == 0 && input.unit.triangles.size() <= target)
    return Collapsed{input.unit, input.cuts, false, {}};
  if (max_error == 0) {
    std::size_t reached = input.unit.triangles.size();
    if (auto result = collapse_cleanly(input, target, reached)) return std::move(*result);
    return make_issue(IssueCode::decimation_failed, "near " + std::to_string(target) +
                                                        " faces no collapse gives a clean surface; " +
                                                        std::to_string(reached) + " were reached");
  }
  Collapsed result = collapse_within(input, std::max(target, least_faces), max_error);
  if (target > 0 && result.mesh.triangles.size() > target)
    result.notes.push_back("the target of " + std::to_string(target) +
                           " faces is missed: the error bound allows no fewer");
  return result;
}

Status check_options(const DecimateOptions& options) {
  const auto bad = [](const char* what) { return make_issue(IssueCode::usage_bad_value, what); };
  if (!std::isfinite(options.max_error_m) || options.max_error_m < 0)
    return bad("the largest error must be finite and not negative");
  if (options.target_face_count == 0 && options.max_error_m == 0)
    return bad("neither a count of faces nor a largest error is given");
  if (options.target_face_count > 0 && options.target_face_count < least_faces)
    return bad("a closed surface needs 4 faces or more");
  return {};
}

DecimatedSurface unchanged(const TriangleMesh& surface, std::size_t cuts) {
  DecimatedSurface same;
  same.mesh = surface;
  same.report.face_count_before = same.report.face_count_after = surface.triangles.size();
  same.report.volume_before_m3 = same.report.volume_after_m3 = signed_volume(surface);
  same.report.self_intersection_count = cuts;
  return same;
}

Result<DecimatedSurface> decimate(const TriangleMesh& surface, const DecimateOptions& options) {
  if (const Status valid = check_options(options); !valid) return valid.issue();
  if (const Status valid = check_closed_oriented_manifold(surface); !valid) return valid.issue();
  if (!(longest_side(bounding_box(surface.vertices)) > 0))
    return make_issue(IssueCode::surface_no_volume, "all vertices lie in one point");
  const UnitFrame frame = UnitFrame::along_axes_of(surface);
  Input input;
  input.unit = surface;
  for (Point& p : input.unit.vertices) p = frame.to_unit(p);
  // Not of the unit surface: rounding may fold a triangle over where the surface itself is clean.
  input.cuts = find_self_intersections(surface).pairs.size();
  Result<Collapsed> result = collapse(input, options, options.max_error_m / frame.length_m());
  if (!result) return result.issue();
  if (result->mesh.triangles.size() == surface.triangles.size()) return unchanged(surface, input.cuts);
  DecimatedSurface out;
  out.mesh = std::move(result->mesh);
  for (Point& p : out.mesh.vertices) p = frame.to_metres(p);
  out.report.face_count_before = surface.triangles.size();
  out.report.face_count_after = out.mesh.triangles.size();
  out.report.volume_before_m3 = signed_volume(surface);
  out.report.volume_after_m3 = signed_volume(out.mesh);
  out.report.hausdorff_m = two_sided_distance(surface, out.mesh).hausdorff();
  out.report.self_intersection_count = result->cuts;
  out.report.notes = std::move(result->notes);
  return out;
}

}  // namespace

Result<DecimatedSurface> decimate_surface(const TriangleMesh& surface,
                                          const DecimateOptions& options) try {
  return decimate(surface, options);
} catch (const std::exception& e) {
  return make_issue(IssueCode::decimation_failed, e.what());
}

}  // namespace souple
