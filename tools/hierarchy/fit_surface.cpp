// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/fit_surface.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tools/geometry/vector.hpp"
#include "tools/hierarchy/level_report.hpp"
#include "tools/hierarchy/level_surface.hpp"
#include "tools/hierarchy/shape_optimizer.hpp"
#include "tools/hierarchy/surface_goals.hpp"

namespace souple {
namespace {

/// On the way, no tet may fall below this part of its parent's quality, or lose more than a tenth of
/// what it still has.
constexpr double sound_on_the_way = 0.2, least_step_kept = 0.9;
/// Stiffness of the attraction to the goals, in edge lengths^-2, against energies of 1 for a tet that
/// keeps all of its parent's quality, 8 where it keeps 0.7 and 544 where it keeps 0.35.
constexpr double across = 2e4, along = 30;
/// The stiffness across is lowered so where too many tets lost too much (2 of 60 levels of the data
/// set: 94.4 % of the children kept 0.7, or one kept 0.31).
constexpr double pulls[] = {1, 0.3, 0.1};
constexpr double share_to_keep = 0.95, least_to_keep = 0.35;
/// A move of less than this part of an edge lets a node rest.
constexpr double rest = 3e-3;
/// A node that stays farther than this part of its longest edge from its goal, across the surface,
/// counts as held back.
constexpr double held_back = 0.02;
constexpr int most_halvings = 8, harmonic_sweeps = 10, sweeps = 8, sweeps_on_the_way = 4;
/// Of the balancing rounds: vertices find their places along the surface in the first ones; the last
/// two hold them there, as what slides afar leaves the planes that drew it.
constexpr double anchoring[] = {0.01, 0.01, 0.01, 0.01, 0.1, 0.1};
/// Of closest points in the least-squares fit: the projection rule only begins with it, to reach limbs
/// that the coarser level missed.
constexpr int all_lookups = 3, first_lookups = 2;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

class Fitter {
 public:
  Fitter(TetMesh& mesh, const std::vector<Triangle>& boundary,
         const std::vector<double>& parent_quality, const TargetSurface& target, FitRule rule,
         double pull)
      : mesh_(mesh),
        target_(target),
        rule_(rule),
        across_(pull * across),
        surface_(mesh, boundary),
        optimizer_(mesh, parent_quality),
        start_(surface_.positions(mesh)),
        rest2_(mesh.nodes.size()) {
    for (std::size_t i = 0; i < rest2_.size(); ++i) rest2_[i] = rest * rest * squared_edge(i);
  }

  std::size_t run() {
    goals_ = rule_ == FitRule::nearest_three
                 ? nearest_three_goals(start_, target_)
                 : least_squares_goals(surface_, start_, target_,
                                       rule_ == FitRule::projection ? first_lookups : all_lookups);
    attract_alike();
    approach(sweeps);
    if (rule_ == FitRule::projection) {
      for (const double& anchor : anchoring) {
        BalancedGoals balanced = balanced_goals(surface_, surface_.positions(mesh_), target_, anchor);
        goals_ = std::move(balanced.places);
        urgency_ = std::move(balanced.urgency);
        attract(balanced.metrics);
        approach(&anchor == std::end(anchoring) - 1 ? sweeps : sweeps_on_the_way);
      }
    }
    return count_held_back();
  }

 private:
  /// Mean square of the edges at a node, m^2.
  double squared_edge(std::size_t node) const {
    double sum = 0;
    for (const auto& [tet, corner] : optimizer_.node_tets().of(node))
      for (const Index j : mesh_.tets[at(tet)])
        sum += squared_norm(subtract(mesh_.nodes[at(j)], mesh_.nodes[node]));
    return sum / static_cast<double>(3 * optimizer_.node_tets().of(node).size());
  }

  void attract(const std::vector<Symmetric>& metrics) {
    const std::vector<Point> x = surface_.positions(mesh_);
    attractions_.resize(x.size());
    for (std::size_t v = 0; v < x.size(); ++v) {
      const double reach = surface_.reach(x, v), unit = 1 / (reach * reach);
      Symmetric stiffness;
      for (std::size_t k = 0; k < 6; ++k)
        stiffness[k] = unit * (across_ * urgency_[v] * metrics[v][k] + (k < 3 ? along : 0));
      attractions_[v] = {goals_[v], stiffness};
    }
  }
  void attract_alike() {
    urgency_.assign(goals_.size(), 1);
    attract(std::vector<Symmetric>(goals_.size(), {1, 1, 1, 0, 0, 0}));
  }

  void approach(int sweep_count) {
    advance();
    awake_.assign(mesh_.nodes.size(), true);
    for (int sweep = 0; sweep < sweep_count; ++sweep) smooth();
  }

  /// Across the surface only: along it, goals are mere wishes.
  std::size_t count_held_back() const {
    std::size_t count = 0;
    for (std::size_t v = 0; v < goals_.size(); ++v) {
      const auto& [goal, stiffness] = attractions_[v];
      const Point left = subtract(goal, mesh_.nodes[at(surface_.nodes[v])]);
      const double across2 = dot(left, times(stiffness, left)) / (across_ * urgency_[v]);
      if (across2 > held_back * held_back) ++count;
    }
    return count;
  }

  /// What is left to go at the boundary, carried into the inside as a harmonic field.
  std::vector<Point> moves() const {
    std::vector<Point> moves(mesh_.nodes.size());
    for (std::size_t v = 0; v < goals_.size(); ++v) {
      const std::size_t i = at(surface_.nodes[v]);
      moves[i] = subtract(goals_[v], mesh_.nodes[i]);
    }
    for (int sweep = 0; sweep < harmonic_sweeps; ++sweep)
      for (std::size_t i = 0; i < moves.size(); ++i)
        if (surface_.vertex_of[i] < 0) moves[i] = mean_around(moves, i);
    return moves;
  }

  Point mean_around(const std::vector<Point>& values, std::size_t node) const {
    Point sum{};
    std::size_t count = 0;
    for (const auto& [tet, corner] : optimizer_.node_tets().of(node))
      for (const Index j : mesh_.tets[at(tet)])
        if (at(j) != node) {
          sum = add(sum, values[at(j)]);
          ++count;
        }
    return scaled(sum, 1 / static_cast<double>(std::max<std::size_t>(count, 1)));
  }

  /// All nodes set out at once; those of a tet that would suffer too much halve their step and, in the
  /// end, stay, until every tet is sound. Tets are sound at the start, so this ends.
  void advance() {
    const std::vector<Point> from = mesh_.nodes, step = moves();
    std::vector<double> least(mesh_.tets.size());
    for (std::size_t t = 0; t < least.size(); ++t)
      least[t] = std::min(sound_on_the_way, least_step_kept * optimizer_.kept(t));
    std::vector<int> halvings(from.size(), 0);
    for (bool all_sound = false; !all_sound;) {
      for (std::size_t i = 0; i < from.size(); ++i)
        mesh_.nodes[i] = halvings[i] >= most_halvings
                             ? from[i]
                             : add_scaled(from[i], std::ldexp(1.0, -halvings[i]), step[i]);
      all_sound = true;
      std::vector<bool> shorten(from.size(), false);
      for (std::size_t t = 0; t < least.size(); ++t)
        if (!(optimizer_.kept(t) >= least[t]))
          for (const Index i : mesh_.tets[t]) shorten[at(i)] = true;
      for (std::size_t i = 0; i < from.size(); ++i)
        if (shorten[i] && halvings[i] < most_halvings) {
          ++halvings[i];
          all_sound = false;
        }
    }
  }

  /// Every node to where it is best; a node at rest is left alone until one beside it moves.
  void smooth() {
    for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
      if (!awake_[i]) continue;
      const Index v = surface_.vertex_of[i];
      const Point from = mesh_.nodes[i];
      mesh_.nodes[i] = optimizer_.improved(i, v < 0 ? Attraction{} : attractions_[at(v)]);
      awake_[i] = false;
      if (squared_norm(subtract(mesh_.nodes[i], from)) > rest2_[i]) wake_around(i);
    }
  }

  void wake_around(std::size_t node) {
    for (const auto& [tet, corner] : optimizer_.node_tets().of(node))
      for (const Index i : mesh_.tets[at(tet)]) awake_[at(i)] = true;
  }

  TetMesh& mesh_;
  const TargetSurface& target_;
  FitRule rule_;
  double across_;  ///< stiffness across the surface, in edge lengths^-2
  LevelSurface surface_;
  ShapeOptimizer optimizer_;
  std::vector<Point> start_, goals_;  ///< of the surface's vertices, m
  std::vector<double> urgency_;       ///< of the surface's vertices: factors of `across`
  std::vector<Attraction> attractions_;
  std::vector<bool> awake_;    ///< nodes to be smoothed
  std::vector<double> rest2_;  ///< square of the move below which a node rests, m^2
};

}  // namespace

std::size_t fit_to_surface(TetMesh& mesh, const std::vector<Triangle>& boundary,
                           const std::vector<double>& parent_quality, const TargetSurface& target,
                           FitRule rule) {
  if (rule == FitRule::none) return 0;
  const TetMesh start = mesh;
  std::size_t held_back_count = 0;
  for (const double pull : pulls) {
    mesh = start;
    held_back_count = Fitter(mesh, boundary, parent_quality, target, rule, pull).run();
    const ChildQuality kept = child_quality(mesh, parent_quality);
    if (kept.share_keeping_70 >= share_to_keep && kept.worst_kept >= least_to_keep) break;
  }
  return held_back_count;
}

}  // namespace souple
