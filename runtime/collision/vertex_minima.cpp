// SPDX-License-Identifier: MIT
#include "runtime/collision/vertex_minima.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "runtime/collision/leaf_pairs.hpp"

namespace souple {
namespace {

class VertexSearch {
 public:
  VertexSearch(const MinimaSearch& search, bool flipped)
      : search_(search),
        work_(*search.work),
        x_(flipped ? *search.b : *search.a),
        y_(flipped ? *search.a : *search.b),
        flipped_(flipped),
        beside_(beside_part * search.alarm_distance) {}

  void run() {
    collect_hits();
    work_.seen.clear(std::size_t(x_.topology().vertex_count()));
    work_.touched.clear(x_.topology().component_first.size());
    work_.open.clear();
    for (std::size_t first = 0; first < work_.hits.size();) {
      std::size_t last = first;
      while (last < work_.hits.size() && work_.hits[last].vertex == work_.hits[first].vertex) ++last;
      judge({work_.hits.data() + first, last - first});
      first = last;
    }
    if (search_.inside_reach > search_.alarm_distance) {
      seed_from_piercing();
      if (!search_.is_self()) seed_from_swallowed();
      flood();
    }
  }

 private:
  void collect_hits() {
    work_.hits.clear();
    for (const TreeNodePair& pair : work_.leaves) {
      collect_leaf(flipped_ ? pair.b : pair.a, flipped_ ? pair.a : pair.b);
      if (search_.is_self() && pair.a != pair.b) collect_leaf(pair.b, pair.a);
    }
    std::ranges::sort(work_.hits, {}, [](const VertexHit& h) {
      return std::tuple(h.vertex, std::abs(h.minimum.gap), h.minimum.feature, h.minimum.triangle);
    });
  }

  void collect_leaf(Index leaf_x, Index leaf_y) {
    const double radius = search_.alarm_distance;
    const auto triangles = y_.tree().leaf_triangles(y_.tree().tree()[leaf_y]);
    for (const Index v : x_.tree().leaf_vertices(x_.tree().tree()[leaf_x])) {
      const Vec3 point = x_.position(v);
      if (squared_distance(y_.box(leaf_y), point) > radius * radius) continue;
      for (const Index t : triangles) {
        if (search_.is_self() && std::ranges::count(y_.topology().corners[t], v) > 0) continue;
        const PointMinima minima = point_minima(y_, t, point, radius, beside_);
        for (int k = 0; k < minima.count; ++k)
          if (is_allowed(v, minima.found[k])) work_.hits.push_back({v, minima.found[k]});
      }
    }
  }

  SurfacePoint vertex_point(Index v) const { return {1, {x_.topology().nodes[v], 0, 0}, {1, 0, 0}}; }

  // Of two bodies every pair is; of one, those that are not neighbours at rest.
  bool is_allowed(Index v, const PointMinimum& minimum) const {
    if (!search_.is_self()) return true;
    const double rest = rest_distance(x_, vertex_point(v), surface_point(y_, minimum));
    if (rest <= search_.alarm_distance) return false;
    return minimum.gap >= 0 || -minimum.gap <= self_depth_part * rest;
  }

  bool faces(const Vec3& vertex_normal, const PointMinimum& minimum) const {
    return minimum.normal.dot(vertex_normal) <= same_side_cosine;
  }

  // A place that faces away from a side on which the vertex lies is on the other side of the body: the
  // vertex has not come that way, however deep it is below.
  bool is_other_side(std::span<const VertexHit> hits, const PointMinimum& place) const {
    if (place.gap >= -beside_) return false;
    for (const VertexHit& hit : hits) {
      if (std::abs(hit.minimum.gap) > beside_) break;
      if (hit.minimum.normal.dot(place.normal) < other_side_cosine) return true;
    }
    return false;
  }

  // A thin part that is crushed flat passes through itself: both its sides are as near, and one of them
  // has the vertex inside.
  bool is_contradicted(std::span<const VertexHit> hits, const PointMinimum& inside) const {
    return std::ranges::any_of(hits, [&](const VertexHit& hit) {
      return hit.minimum.gap > 0 && std::abs(hit.minimum.gap + inside.gap) <= beside_;
    });
  }

  // On an edge of the surface it winds by a quarter.
  bool is_sure(Index v, std::span<const VertexHit> hits, const PointMinimum& inside) const {
    constexpr double well_outside = 0.1;
    if (search_.is_self() || inside.gap >= -beside_) return true;
    if (!is_doubtful(inside.closest) && !is_contradicted(hits, inside)) return true;
    return winding_number(y_, x_.position(v)) > well_outside;
  }

  // All hits of one vertex, the nearest first: it tells inside from outside, unless the vertex slides
  // along a side that does not face it.
  void judge(std::span<const VertexHit> hits) {
    const Index v = hits.front().vertex;
    work_.seen.set(v, 1);
    work_.touched.set(x_.topology().component[v], 1);
    const Vec3 normal = x_.normal_of_vertex(v);
    const auto judged = std::ranges::find_if(hits, [&](const VertexHit& hit) {
      return !is_other_side(hits, hit.minimum) &&
             (hit.minimum.gap < 0 || hit.minimum.gap > beside_ || faces(normal, hit.minimum));
    });
    if (judged == hits.end() || (judged->minimum.gap < 0 && is_sure(v, hits, judged->minimum))) {
      judge_inside(v, normal, hits);
    } else {
      judge_outside(v, normal, hits);
    }
  }

  void judge_inside(Index v, const Vec3& normal, std::span<const VertexHit> hits) {
    for (const Index next : x_.topology().ring(v)) work_.open.push_back(next);
    for (const double limit : {same_side_cosine, grazing_cosine})
      for (const VertexHit& hit : hits) {
        const PointMinimum& m = hit.minimum;
        if (m.gap > beside_ || m.normal.dot(normal) > limit || is_other_side(hits, m)) continue;
        if (-m.gap <= search_.inside_reach) emit(v, m);
        return;
      }
    if (search_.inside_reach > search_.alarm_distance) add_deep(v, normal, hits);
  }

  void judge_outside(Index v, const Vec3& normal, std::span<const VertexHit> hits) {
    const std::size_t start = work_.near.size();
    for (const VertexHit& hit : hits) {
      const PointMinimum& m = hit.minimum;
      if (m.gap < 0 || !faces(normal, m)) continue;
      const bool is_face = m.feature >= y_.tree().face_feature(0);
      if (!(is_face && m.gap <= sure_part * search_.alarm_distance) &&
          !in_vertex_cone(x_, v, -m.normal, vertex_cone_slack))
        continue;
      const bool is_known = std::any_of(
          work_.near.begin() + std::ptrdiff_t(start), work_.near.end(),
          [&](const PointMinimum& other) { return other.normal.dot(m.normal) > merging_cosine; });
      if (is_known) continue;
      work_.near.push_back(m);
      emit(v, m);
    }
    work_.near.resize(start);
  }

  // The nearest place within reach that faces a vertex inside, `hits` being the near ones; false: none.
  bool add_deep(Index v, const Vec3& normal, std::span<const VertexHit> hits) {
    const Vec3 point = x_.position(v);
    std::optional<PointMinimum> best;
    const double radius = search_.inside_reach;
    y_.for_triangles_near(point, radius, [&](Index t) {
      if (search_.is_self() && std::ranges::count(y_.topology().corners[t], v) > 0) return;
      const PointMinima minima = point_minima(y_, t, point, radius, beside_);
      for (int k = 0; k < minima.count; ++k) {
        const PointMinimum& found = minima.found[k];
        if (found.gap >= 0 || !faces(normal, found) || !is_allowed(v, found)) continue;
        if (is_other_side(hits, found)) continue;
        if (!best || std::pair(-found.gap, found.feature) < std::pair(-best->gap, best->feature))
          best = found;
      }
    });
    if (best) emit(v, *best);
    return best.has_value();
  }

  void seed_from_piercing() {
    for (const Index edge : work_.piercing[flipped_ ? 1 : 0])
      for (const Index v : x_.topology().edges[edge].vertex) {
        work_.open.push_back(v);
        work_.touched.set(x_.topology().component[v], 1);
      }
  }

  // A part that touches nothing is outside altogether, or inside.
  void seed_from_swallowed() {
    const auto& firsts = x_.topology().component_first;
    for (std::size_t c = 0; c < firsts.size(); ++c)
      if (!work_.touched.has(static_cast<Index>(c))) work_.open.push_back(firsts[c]);
  }

  // The nearest side may be the back of a thin part that passes through itself.
  bool is_swallowed(const Vec3& point) const {
    return is_inside(y_, point) && winding_number(y_, point) > 0.5;
  }

  // Vertices inside that are farther than the alarm distance from the surface hang together with others
  // inside, or with edges that pass through it.
  void flood() {
    while (!work_.open.empty()) {
      const Index v = work_.open.back();
      work_.open.pop_back();
      if (!work_.seen.set(v, 1)) continue;
      if (!search_.is_self() && !is_swallowed(x_.position(v))) continue;
      if (!add_deep(v, x_.normal_of_vertex(v), {}) && search_.is_self()) continue;
      for (const Index next : x_.topology().ring(v))
        if (!work_.seen.has(next)) work_.open.push_back(next);
    }
  }

  void emit(Index v, const PointMinimum& m) {
    LocalMinimum found;
    const SurfacePoint vertex = vertex_point(v), other = surface_point(y_, m);
    const Index feature = x_.tree().vertex_feature(v);
    // Of a surface with itself, a pair of vertices has its lower one first.
    const bool vertex_is_b = flipped_ || (search_.is_self() && m.feature < feature);
    found.a = vertex_is_b ? other : vertex;
    found.b = vertex_is_b ? vertex : other;
    found.feature_a = vertex_is_b ? m.feature : feature;
    found.feature_b = vertex_is_b ? feature : m.feature;
    found.normal = vertex_is_b ? Vec3(-m.normal) : m.normal;
    found.point_b = vertex_is_b ? x_.position(v) : m.closest.point;
    found.gap = m.gap;
    search_.out->push_back(found);
  }

  const MinimaSearch& search_;
  ProximityWork::Arrays& work_;
  const DeformedSurface& x_;
  const DeformedSurface& y_;
  bool flipped_;
  double beside_;
};

}  // namespace

double rest_distance(const DeformedSurface& s, const SurfacePoint& p, const SurfacePoint& q) {
  const auto at_rest = [&](const SurfacePoint& point) {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < point.count; ++k)
      sum += point.weight[k] * s.tree().rest_position(s.topology().vertex_of_node[point.node[k]]);
    return sum;
  };
  return (at_rest(p) - at_rest(q)).norm();
}

void find_vertex_minima(const MinimaSearch& search, bool flipped) {
  VertexSearch(search, flipped).run();
}

}  // namespace souple
