// SPDX-License-Identifier: MIT
#include <algorithm>

#include "runtime/collision/leaf_pairs.hpp"
#include "runtime/collision/vertex_minima.hpp"

namespace souple {
namespace {

FloatBox edge_box(const DeformedSurface& s, Index edge) {
  const auto& ends = s.topology().edges[edge].vertex;
  const __m128 p = _mm_load_ps(s.rough_position(ends[0]).data());
  const __m128 q = _mm_load_ps(s.rough_position(ends[1]).data());
  const __m128 margin = _mm_set1_ps(s.rounding());
  FloatBox box;
  _mm_store_ps(box.low.data(), _mm_sub_ps(_mm_min_ps(p, q), margin));
  _mm_store_ps(box.high.data(), _mm_add_ps(_mm_max_ps(p, q), margin));
  return box;
}

const Ridge* ridge_in(RidgeTable& table, const DeformedSurface& s, Index edge) {
  if (!table.slot.has(edge)) {
    const auto ridge = ridge_of(s, edge);
    table.slot.set(edge, ridge ? static_cast<Index>(table.ridges.size()) : -1);
    if (ridge) table.ridges.push_back(*ridge);
  }
  return table.slot[edge] < 0 ? nullptr : &table.ridges[table.slot[edge]];
}

void start_table(RidgeTable& table, const DeformedSurface& s) {
  table.slot.clear(std::size_t(s.topology().edge_count()));
  table.ridges.clear();
}

SurfacePoint edge_point(const DeformedSurface& s, Index edge, double along) {
  const auto& ends = s.topology().edges[edge].vertex;
  return {2, {s.topology().nodes[ends[0]], s.topology().nodes[ends[1]], 0}, {1 - along, along, 0}};
}

// Of any edge, without a cone.
Ridge bare_edge(const DeformedSurface& s, Index edge) {
  const auto& [ends, triangles] = s.topology().edges[edge];
  Vec3 outward = Vec3::Zero();
  for (const Index t : triangles)
    if (t >= 0) outward += s.face_normal(t);
  return {s.position(ends[0]), s.position(ends[1]), {}, outward.normalized()};
}

bool share_vertex(const CollisionTopology& topology, Index e, Index f) {
  const auto &p = topology.edges[e].vertex, &q = topology.edges[f].vertex;
  return p[0] == q[0] || p[0] == q[1] || p[1] == q[0] || p[1] == q[1];
}

void pierce_leaf(const MinimaSearch& search, int from, Index leaf_x, Index leaf_y) {
  const DeformedSurface& x = from == 0 ? *search.a : *search.b;
  const DeformedSurface& y = from == 0 ? *search.b : *search.a;
  for (const Index e : x.tree().leaf_edges(x.tree().tree()[leaf_x])) {
    if (squared_distance(edge_box(x, e), y.box(leaf_y)) > 0) continue;
    const auto& ends = x.topology().edges[e].vertex;
    for (const Index t : y.tree().leaf_triangles(y.tree().tree()[leaf_y])) {
      const auto& corners = y.topology().corners[t];
      if (search.is_self() &&
          (std::ranges::count(corners, ends[0]) > 0 || std::ranges::count(corners, ends[1]) > 0))
        continue;
      if (!pierces(x.position(ends[0]), x.position(ends[1]), y.corner(t, 0), y.corner(t, 1),
                   y.corner(t, 2)))
        continue;
      search.work->piercing[from].push_back(e);
      break;
    }
  }
}

class EdgeSearch {
 public:
  explicit EdgeSearch(const MinimaSearch& search)
      : search_(search), work_(*search.work), a_(*search.a), b_(*search.b) {}

  void run() {
    start_table(work_.ridges[0], a_);
    start_table(work_.ridges[1], b_);
    for (const TreeNodePair& pair : work_.leaves) add_leaf(pair);
    const auto &in_b = work_.piercing[0], &in_a = work_.piercing[search_.is_self() ? 0 : 1];
    const float radius2 = box_radius(search_.inside_reach);
    for (const Index e : in_b)
      for (const Index f : in_a)
        if (is_pair(e, f) && squared_distance(edge_box(a_, e), edge_box(b_, f)) <= radius2)
          add_piercing(e, f);
  }

 private:
  bool is_pair(Index e, Index f) const {
    return !search_.is_self() || (e < f && !share_vertex(a_.topology(), e, f));
  }

  void add_leaf(const TreeNodePair& pair) {
    const float radius2 = box_radius(search_.alarm_distance);
    for (const Index e : a_.tree().leaf_edges(a_.tree().tree()[pair.a])) {
      const FloatBox box = edge_box(a_, e);
      if (squared_distance(box, b_.box(pair.b)) > radius2 || !ridge_in(work_.ridges[0], a_, e))
        continue;
      for (const Index f : b_.tree().leaf_edges(b_.tree().tree()[pair.b])) {
        if (squared_distance(box, edge_box(b_, f)) > radius2) continue;
        // Of one surface the lower edge is A, whichever leaf it is in.
        const bool swap = search_.is_self() && pair.a != pair.b && f < e;
        if (is_pair(swap ? f : e, swap ? e : f)) add_shallow(swap ? f : e, swap ? e : f);
      }
    }
  }

  // Edges that end a step past each other need not pierce a face; deep ones would be sought among too
  // many that do not.
  bool is_deep(double gap) const { return gap < -sure_part * search_.alarm_distance; }

  void add_shallow(Index e, Index f) {
    const auto found = minimum(e, f, [&](double gap) { return !is_deep(gap); });
    if (found) search_.out->push_back(*found);
  }

  void add_piercing(Index e, Index f) {
    auto found = minimum(e, f, [](double) { return true; });
    if (found && !is_deep(found->gap)) return;  // known from the leaves
    if (!found && !search_.is_self()) found = nick(e, f);
    if (found) search_.out->push_back(*found);
  }

  template <class Predicate>
  std::optional<LocalMinimum> minimum(Index e, Index f, const Predicate& is_wanted) {
    const Ridge* ridge_f = ridge_in(work_.ridges[1], b_, f);
    const Ridge* ridge_e = ridge_in(work_.ridges[0], a_, e);
    if (!ridge_e || !ridge_f) return {};
    const auto least = edge_minimum(*ridge_e, *ridge_f);
    if (!least || !is_wanted(least->gap) || !is_within_reach(least->gap)) return {};
    const LocalMinimum found = local_minimum(e, f, *least);
    if (!is_true(found, lens_point(*ridge_e, *ridge_f, *least))) return {};
    return found;
  }

  bool is_within_reach(double gap) const {
    return gap <= search_.alarm_distance && gap >= -search_.inside_reach;
  }

  LocalMinimum local_minimum(Index e, Index f, const EdgeMinimum& minimum) const {
    LocalMinimum found;
    found.a = edge_point(a_, e, minimum.along_a);
    found.b = edge_point(b_, f, minimum.along_b);
    found.feature_a = a_.tree().edge_feature(e);
    found.feature_b = b_.tree().edge_feature(f);
    found.normal = minimum.normal;
    const auto& ends = b_.topology().edges[f].vertex;
    const Vec3 from = b_.position(ends[0]);
    found.point_b = from + minimum.along_b * (b_.position(ends[1]) - from);
    found.gap = minimum.gap;
    return found;
  }

  // Two edges that have cut right through each other, with no vertex inside: nothing else holds them
  // apart, whatever the cones say (on ridges that are not convex all along). One of them may be flat:
  // it is then held only from as deep as it may stand out unseen, or contacts would come and go.
  std::optional<LocalMinimum> nick(Index e, Index f) {
    const Ridge edge_a = bare_edge(a_, e), edge_b = bare_edge(b_, f);
    const bool is_flat_a = !ridge_in(work_.ridges[0], a_, e);
    const bool is_flat_b = !ridge_in(work_.ridges[1], b_, f);
    if (is_flat_a && is_flat_b) return {};
    if (!cuts_beside(a_, e, b_, f) || !cuts_beside(b_, f, a_, e)) return {};
    const auto crossing = edge_crossing(edge_a, edge_b);
    if (!crossing || crossing->gap >= 0 || !is_within_reach(crossing->gap)) return {};
    LocalMinimum found = local_minimum(e, f, *crossing);
    const Vec3 point_a = found.point_b + found.gap * found.normal;
    for (const double share : between_edges) {
      const Vec3 place = found.point_b + share * (point_a - found.point_b);
      if (std::min(depth_inside(a_, place), depth_inside(b_, place)) <= -thin_part * found.gap)
        return {};
    }
    if (!ends_outside(a_, e, b_) || !ends_outside(b_, f, a_)) return {};
    if (is_flat_a) found.gap += flat_part * (edge_a.to - edge_a.from).norm();
    if (is_flat_b) found.gap += flat_part * (edge_b.to - edge_b.from).norm();
    return found;
  }

  // Whether an edge of x pierces a face beside an edge of y.
  static bool cuts_beside(const DeformedSurface& x, Index edge_x, const DeformedSurface& y,
                          Index edge_y) {
    const auto& ends = x.topology().edges[edge_x].vertex;
    return std::ranges::any_of(y.topology().edges[edge_y].triangle, [&](Index t) {
      return t >= 0 && pierces(x.position(ends[0]), x.position(ends[1]), y.corner(t, 0), y.corner(t, 1),
                               y.corner(t, 2));
    });
  }

  static bool ends_outside(const DeformedSurface& x, Index edge_x, const DeformedSurface& y) {
    return std::ranges::none_of(x.topology().edges[edge_x].vertex,
                                [&](Index v) { return is_inside(y, x.position(v)); });
  }

  // Of one body, near at rest is no contact; of two, edges that penetrate have both inside between
  // them.
  bool is_true(const LocalMinimum& found, const Vec3& between) const {
    if (search_.is_self()) {
      const double rest = rest_distance(a_, found.a, found.b);
      return rest > search_.alarm_distance && -found.gap <= self_depth_part * rest;
    }
    const double depth = -lens_part * found.gap;
    return found.gap >= 0 || (depth_inside(b_, between) > depth && depth_inside(a_, between) > depth);
  }

  const MinimaSearch& search_;
  ProximityWork::Arrays& work_;
  const DeformedSurface& a_;
  const DeformedSurface& b_;
};

}  // namespace

void find_piercing_edges(const MinimaSearch& search) {
  auto& work = *search.work;
  for (auto& edges : work.piercing) edges.clear();
  for (const TreeNodePair& pair : work.leaves) {
    if (squared_distance(search.a->box(pair.a), search.b->box(pair.b)) > 0) continue;
    pierce_leaf(search, 0, pair.a, pair.b);
    if (!search.is_self()) {
      pierce_leaf(search, 1, pair.b, pair.a);
    } else if (pair.a != pair.b) {
      pierce_leaf(search, 0, pair.b, pair.a);
    }
  }
  for (auto& edges : work.piercing) {
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  }
}

void find_edge_minima(const MinimaSearch& search) { EdgeSearch(search).run(); }

}  // namespace souple
