// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/fit_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr std::size_t nearest_triangles = 3;
/// A move may not push a tet below this mean ratio (a smallest dihedral angle of about 8 degrees); one
/// that is poor from birth may lose at most a tenth of what it had.
constexpr double least_mean_ratio = 0.25, least_kept = 0.9;
/// Inner nodes of tets that lost more than this part of their quality are smoothed.
constexpr double suffered = 0.85;
constexpr int most_halvings = 8;
constexpr int rounds = 6;
/// A node with more than this part of its way still to go counts as held back.
constexpr double arrived = 0.01;
constexpr int smoothing_sweeps = 3;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

double quality(const Tet& tet, const std::vector<Point>& x) {
  return mean_ratio(x[at(tet[0])], x[at(tet[1])], x[at(tet[2])], x[at(tet[3])]);
}

/// The tets of every node, as one list with offsets.
class NodeTets {
 public:
  explicit NodeTets(const TetMesh& mesh)
      : first_(mesh.nodes.size() + 1, 0), tets_(4 * mesh.tets.size()) {
    for (const Tet& tet : mesh.tets)
      for (const Index i : tet) ++first_[at(i) + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
      for (const Index i : mesh.tets[t]) tets_[next[at(i)]++] = t;
  }
  std::span<const std::size_t> of(std::size_t node) const {
    return {tets_.data() + first_[node], first_[node + 1] - first_[node]};
  }

 private:
  std::vector<std::size_t> first_, tets_;
};

class Fitter {
 public:
  Fitter(TetMesh& mesh, const std::vector<Triangle>& boundary, const TriangleBvh& target)
      : mesh_(mesh), node_tets_(mesh), surface_(used_nodes(boundary)), is_surface_(mesh.nodes.size()) {
    for (const Index i : surface_) {
      is_surface_[at(i)] = true;
      goals_.push_back(goal_of(mesh.nodes[at(i)], target));
    }
    for (const Tet& tet : mesh.tets) unfitted_.push_back(quality(tet, mesh.nodes));
  }

  std::size_t run() {
    const std::vector<Point> start = mesh_.nodes;
    std::size_t held_back = 0;
    for (int round = 0; round < rounds; ++round) {
      move_towards_goals();
      smooth_inside();
      held_back = count_held_back(start);
      if (held_back == 0) break;
    }
    return held_back;
  }

 private:
  /// ★Departs from METHOD 3.2: the closest points are weighted by the inverse square of their distance
  /// and their barycentre is brought back to the surface. The plain rule expects triangles smaller than
  /// the level's. On a machine part with large flat faces it pulls nodes along a face to its far edges
  /// (largest distance 12.6 mm on a body of 200 mm where the midpoints had 5.2 mm; weighted alone 2.8
  /// mm, as here 1.8 mm). On a liver, a dinosaur and a bunny the rules differ little.
  static Point goal_of(const Point& p, const TriangleBvh& target) {
    std::array<ClosestPoint, nearest_triangles> closest;
    const std::size_t count = target.nearest(p, closest);
    const double nearest = closest[0].squared_distance;
    if (nearest == 0) return p;
    Point sum{};
    double weights = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const double weight = nearest / closest[k].squared_distance;
      sum = add_scaled(sum, weight, closest[k].point);
      weights += weight;
    }
    return target.closest(scaled(sum, 1 / weights)).point;
  }

  std::size_t count_held_back(const std::vector<Point>& start) const {
    std::size_t count = 0;
    for (std::size_t s = 0; s < surface_.size(); ++s) {
      const std::size_t i = at(surface_[s]);
      const double way = squared_norm(subtract(goals_[s], start[i]));
      if (squared_norm(subtract(goals_[s], mesh_.nodes[i])) > arrived * arrived * way) ++count;
    }
    return count;
  }

  bool is_sound(std::size_t tet) const {
    return quality(mesh_.tets[tet], mesh_.nodes) >=
           std::min(least_mean_ratio, least_kept * unfitted_[tet]);
  }

  /// All nodes set out at once; those of a tet that would suffer too much halve their step and, in the
  /// end, stay, until every tet is sound. Tets are sound at the start, so this ends.
  void move_towards_goals() {
    const std::vector<Point> start = mesh_.nodes;
    std::vector<int> halvings(start.size(), 0);
    for (bool all_sound = false; !all_sound;) {
      place(start, halvings);
      all_sound = true;
      std::vector<bool> shorten(start.size(), false);
      for (std::size_t t = 0; t < mesh_.tets.size(); ++t)
        if (!is_sound(t))
          for (const Index i : mesh_.tets[t]) shorten[at(i)] = true;
      for (const Index i : surface_)
        if (shorten[at(i)] && halvings[at(i)] < most_halvings) {
          ++halvings[at(i)];
          all_sound = false;
        }
    }
  }

  void place(const std::vector<Point>& start, const std::vector<int>& halvings) {
    for (std::size_t s = 0; s < surface_.size(); ++s) {
      const std::size_t i = at(surface_[s]);
      const double step = halvings[i] == most_halvings ? 0 : std::ldexp(1.0, -halvings[i]);
      mesh_.nodes[i] =
          step == 1 ? goals_[s] : add_scaled(start[i], step, subtract(goals_[s], start[i]));
    }
  }

  void smooth_inside() {
    for (int sweep = 0; sweep < smoothing_sweeps; ++sweep)
      for (std::size_t i = 0; i < mesh_.nodes.size(); ++i)
        if (!is_surface_[i] && has_suffered(i)) smooth(i);
  }

  bool has_suffered(std::size_t node) const {
    return std::ranges::any_of(node_tets_.of(node), [&](std::size_t t) {
      return quality(mesh_.tets[t], mesh_.nodes) < suffered * unfitted_[t];
    });
  }

  double worst_around(std::size_t node) const {
    double worst = 1;
    for (const std::size_t t : node_tets_.of(node))
      worst = std::min(worst, quality(mesh_.tets[t], mesh_.nodes));
    return worst;
  }

  /// Towards the middle of its tets, all or half or a quarter of the way, if the worst tet gains.
  void smooth(std::size_t node) {
    const Point start = mesh_.nodes[node];
    const double before = worst_around(node);
    Point sum{};
    for (const std::size_t t : node_tets_.of(node))
      for (const Index i : mesh_.tets[t]) sum = add(sum, mesh_.nodes[at(i)]);
    const Point middle = scaled(sum, 0.25 / static_cast<double>(node_tets_.of(node).size()));
    for (const double step : {1.0, 0.5, 0.25}) {
      mesh_.nodes[node] = add_scaled(start, step, subtract(middle, start));
      if (worst_around(node) > before) return;
    }
    mesh_.nodes[node] = start;
  }

  TetMesh& mesh_;
  NodeTets node_tets_;
  std::vector<Index> surface_;
  std::vector<bool> is_surface_;
  std::vector<Point> goals_;      ///< of surface_[k], m
  std::vector<double> unfitted_;  ///< quality of every tet before any move
};

}  // namespace

double mean_ratio(const Point& a, const Point& b, const Point& c, const Point& d) {
  double edges2 = 0;
  for (const Point& e :
       {subtract(b, a), subtract(c, a), subtract(d, a), subtract(c, b), subtract(d, b), subtract(d, c)})
    edges2 += squared_norm(e);
  if (!(edges2 > 0)) return 0;
  const double volume3 = signed_volume6(a, b, c, d) / 2;
  return std::copysign(12 * std::pow(std::abs(volume3), 2.0 / 3.0) / edges2, volume3);
}

std::size_t fit_to_surface(TetMesh& mesh, const std::vector<Triangle>& boundary,
                           const TriangleBvh& target) {
  return Fitter(mesh, boundary, target).run();
}

}  // namespace souple
