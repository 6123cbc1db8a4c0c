// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/size_goal.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "tools/geometry/surface_measure.hpp"

namespace souple {
namespace {

constexpr std::size_t most_attempts = 7;
/// How near the goal the refinement must come; perturbing and exuding may then add as much.
constexpr double good_enough = 0.06;
/// Perturbing and exuding leave about this part of the refinement's tets.
constexpr double left_by_optimisation = 0.985;
/// A mesh of cell radius h has about cells V / h^3 + skin A / h^2 tets.
constexpr double cells = 3.9, skin = 2.2;
constexpr double tets_per_node = 4.5;
/// Above that many tets a run at an eighth of the count, which costs little, tells how this shape
/// differs from the model.
constexpr double worth_a_trial = 6000;
constexpr double largest_radius = 0.5, smallest_radius = 1e-4;

using Kind = SizeGoal::Kind;

/// The radius at which `scale` times the model gives `count`, by bisection of its logarithm.
double radius_for(const SizeGoal& goal, double count, double scale) {
  double low = smallest_radius, high = largest_radius;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    (scale * goal.expected_tets(middle) > count ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

/// Towards the goal: along the line through the last two attempts in log-log, or by the model.
double next_radius(const std::vector<SizeAttempt>& attempts, const SizeGoal& goal, double target) {
  const SizeAttempt& last = attempts.back();
  const bool counting = goal.kind == Kind::tet_count;
  const double ratio = target / last.measure;
  double radius = counting ? radius_for(goal, target, last.measure / goal.expected_tets(last.radius))
                           : last.radius * ratio;
  if (attempts.size() > 1) {
    const SizeAttempt& before = attempts[attempts.size() - 2];
    const double run = std::log(last.radius / before.radius);
    const double rise = std::log(last.measure / before.measure);
    const double least = counting ? -4.5 : 0.3, most = counting ? -1.0 : 1.5;
    // A long stride says less of the slope than the model does.
    if (std::abs(run) > 1e-6 && std::abs(run) < 0.5)
      radius = last.radius * std::exp(std::log(ratio) / std::clamp(rise / run, least, most));
  }
  return std::clamp(radius, std::max(smallest_radius, last.radius / 4),
                    std::min(largest_radius, last.radius * 4));
}

double refinement_target(const SizeGoal& goal) {
  return goal.kind == Kind::tet_count ? goal.target / left_by_optimisation : goal.target;
}

double first_radius(const SizeGoal& goal) {
  if (goal.kind != Kind::tet_count) return goal.expected_radius();
  const double target = refinement_target(goal);
  return radius_for(goal, target > worth_a_trial ? target / 8 : target, 1);
}

}  // namespace

double SizeGoal::expected_tets(double radius) const {
  return cells * volume / (radius * radius * radius) + skin * area / (radius * radius);
}

double SizeGoal::expected_radius() const {
  switch (kind) {
    case Kind::tet_count:
      return radius_for(*this, target, 1);
    case Kind::mean_edge:
      return target / edge_per_radius;
    default:
      return target;
  }
}

double SizeGoal::expected_node_count() const {
  return expected_tets(expected_radius()) / tets_per_node;
}

double SizeGoal::miss(double tet_count, double mean_edge) const {
  if (kind == Kind::radius) return 0;
  return std::abs((kind == Kind::tet_count ? tet_count : mean_edge) / target - 1);
}

std::size_t SizeGoal::most_vertices() const {
  if (kind == Kind::radius) return most_tets / 4;
  // Enough for a first guess that is far off. Near-touching sheets are refined without end: every
  // vertex more is lost time.
  return static_cast<std::size_t>(4 * expected_node_count()) + 2'000;
}

Result<SizeGoal> goal_of(const UnitSurface& unit, const TetrahedralizeOptions& options) {
  const auto bad = [](const std::string& what) { return make_issue(IssueCode::usage_bad_value, what); };
  SizeGoal goal{Kind::tet_count, 0, signed_volume(unit.mesh), surface_area(unit.mesh)};
  const double edge = options.edge_length_m / unit.frame.length_m();
  const double error = options.max_error_m / unit.frame.length_m();
  if (edge == 0 && error == 0) {
    if (options.target_tet_count < fewest_tets || options.target_tet_count > most_tets)
      return bad("a target of " + std::to_string(options.target_tet_count) + " tets is outside " +
                 std::to_string(fewest_tets) + " to " + std::to_string(most_tets));
    goal.target = static_cast<double>(options.target_tet_count);
    return goal;
  }
  if (error > 0 && error < 1e-5)
    return bad("an error of less than 1e-5 of the size of the body is below the resolution");
  if (edge == 0) {
    // As coarse as a body can be meshed; the error makes the surface finer where it must be.
    constexpr double coarse = 0.15;
    goal.kind = Kind::radius;
    goal.target = coarse;
    return goal;
  }
  const double radius = edge / edge_per_radius;
  if (!(radius <= 1)) return bad("the edge length exceeds the size of the body");
  if (!(goal.expected_tets(radius) <= static_cast<double>(most_tets)))
    return bad("the edge length asks for more than " + std::to_string(most_tets) + " tets");
  // The mean over the body says nothing of the edge asked for where sizes differ on purpose.
  const bool uniform =
      options.local_sizes.empty() && options.interior_coarsening <= 1 && options.max_error_m == 0;
  goal.kind = uniform ? Kind::mean_edge : Kind::radius;
  goal.target = uniform ? edge : radius;
  return goal;
}

Result<std::vector<SizeAttempt>> refine_to_goal(VolumeMesher& mesher, const Sizing& sizing,
                                                const SizeGoal& goal) {
  const double target = refinement_target(goal);
  const auto miss = [&](const SizeAttempt& a) {
    return goal.kind == Kind::radius ? 0 : std::abs(a.measure / target - 1);
  };
  std::vector<SizeAttempt> attempts;
  const auto refine = [&](double radius) -> Status {
    const Result<RefinedMesh> mesh = mesher.refine(sizing.sizes(radius), goal.most_vertices());
    if (!mesh) return mesh.issue();
    const double count = std::max(1.0, static_cast<double>(mesh->tet_count));
    attempts.push_back({radius, goal.kind == Kind::mean_edge ? mesh->mean_edge : count});
    return {};
  };
  double radius = first_radius(goal);
  while (attempts.empty() || miss(attempts.back()) > good_enough) {
    if (!attempts.empty()) radius = next_radius(attempts, goal, target);
    const bool stuck = !attempts.empty() && std::abs(radius / attempts.back().radius - 1) < 1e-3;
    if (attempts.size() == most_attempts || stuck) {
      const SizeAttempt best = *std::ranges::min_element(attempts, {}, miss);
      if (best.radius == attempts.back().radius) break;
      if (const Status refined = refine(best.radius); !refined) return refined.issue();
      break;
    }
    if (const Status refined = refine(radius); !refined) return refined.issue();
  }
  return attempts;
}

}  // namespace souple
