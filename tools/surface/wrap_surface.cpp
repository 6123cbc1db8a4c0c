// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/wrap_surface.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <utility>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/surface/guarded_step.hpp"
#include "tools/surface/self_intersections.hpp"
#include "tools/surface/surface_difference.hpp"

namespace souple {
namespace {

/// Diagonal of the box over alpha. Beyond 100 a wrap takes over 10 s.
constexpr std::array<double, 5> fineness{8, 16, 28, 45, 70};
constexpr double alpha_over_offset = 20;
/// 2 V / A in offsets; of a double skin it is 2.
constexpr double least_thickness = 3;
/// Area of the wrap over that of the surface; of a double skin it is 2.
constexpr double most_area = 1.5;
/// A flat patch wrapped thickly is supported on a half.
constexpr double least_support = 0.6;
/// Of the volume of the surface itself, or of the next coarser wrap.
constexpr double least_volume = 0.7, collapse = 0.5;
constexpr double spacing = 1.0 / 100;

struct Measure {
  double diagonal = 0;
  double area = 0;
  bool is_closed = false;
  double volume = 0;  ///< 0: unknown
};

std::string rounded(double x) {
  std::ostringstream text;
  text.precision(3);
  text << x;
  return text.str();
}

std::string flaw_of(const TriangleMesh& wrap, const WrapTrial& trial, const Measure& measure,
                    const WrapTrial* coarser) {
  if (wrap.triangles.empty()) return "empty";
  if (const Status sound = check_closed_oriented_manifold(wrap); !sound) return sound.issue().what;
  if (!(trial.volume > 0)) return "no volume";
  if (!measure.is_closed && trial.thickness < least_thickness * trial.offset) return "a double skin";
  if (trial.support < least_support)
    return "only " + rounded(100 * trial.support) + " % of it lies on the surface";
  if (measure.volume > 0 && trial.volume < least_volume * measure.volume)
    return "its volume is " + rounded(trial.volume / measure.volume) + " of the surface's";
  if (!measure.is_closed && coarser != nullptr && trial.volume < collapse * coarser->volume)
    return "its volume collapsed to " + rounded(trial.volume / coarser->volume) +
           " of the coarser wrap's";
  if (!find_self_intersections(wrap, 1).pairs.empty()) return "it cuts itself";
  return {};
}

WrapTrial examine(const TriangleMesh& wrap, double alpha, double offset, const TriangleBvh& base) {
  WrapTrial trial;
  trial.alpha = alpha;
  trial.offset = offset;
  if (wrap.triangles.empty()) return trial;
  trial.volume = signed_volume(wrap);
  const double area = surface_area(wrap);
  trial.thickness = area > 0 ? 2 * trial.volume / area : 0;
  trial.support = share_of_area_near(wrap, base, 3 * offset + alpha / 8, spacing);
  return trial;
}

bool is_sheet(const std::vector<WrapTrial>& trials) {
  return std::ranges::all_of(trials, [](const WrapTrial& t) {
    return t.thickness < least_thickness * t.offset || t.support < least_support;
  });
}

Issue refusal(const std::vector<WrapTrial>& trials) {
  std::string tried;
  for (const WrapTrial& t : trials)
    tried += (tried.empty() ? "" : "; ") + ("alpha " + rounded(t.alpha)) + ": " + t.flaw;
  if (is_sheet(trials))
    return make_issue(IssueCode::surface_hopeless,
                      "wrapped at every size it stays a sheet or leaves the surface (" + tried + ")");
  return make_issue(IssueCode::surface_wrap_failed, tried);
}

}  // namespace

Result<Wrapped> wrap_surface(const TriangleMesh& unit, double max_error, bool is_closed,
                             double volume) {
  const Box box = bounding_box(unit.vertices);
  const Measure measure{norm(subtract(box.high, box.low)), surface_area(unit), is_closed, volume};
  const TriangleBvh base(unit);
  Wrapped wrapped;
  const WrapTrial* coarser = nullptr;
  std::optional<WrapTrial> plausible;
  for (const double parts : fineness) {
    const double alpha = measure.diagonal / parts;
    const double offset = std::min(max_error / 2, alpha / alpha_over_offset);
    Result<MendStep> step = run_guarded([&] { return wrap_triangles(unit, alpha, offset); });
    WrapTrial trial = examine(step ? step->mesh : TriangleMesh{}, alpha, offset, base);
    trial.flaw = step ? flaw_of(step->mesh, trial, measure, coarser) : step.issue().what;
    wrapped.trials.push_back(trial);
    if (trial.flaw.empty()) {
      wrapped.mesh = std::move(step->mesh);
      wrapped.taken = trial;
      plausible = trial;
      coarser = &*plausible;
    } else if (coarser != nullptr) {
      break;
    }
  }
  if (wrapped.mesh.triangles.empty()) return refusal(wrapped.trials);
  return wrapped;
}

}  // namespace souple
