// SPDX-License-Identifier: MIT
// Local minima of distance between two closed surfaces over all pairs of features, by the definition in
// local_minima.hpp and nothing faster.
#pragma once
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "runtime/collision/local_minima.hpp"

namespace souple::test {

struct BruteSurface {
  struct Edge {
    Index p, q;
    std::vector<Index> faces;
  };
  BruteSurface(const std::vector<Triangle>& all, const Eigen::VectorXd& positions)
      : triangles(all), x(&positions) {
    std::map<std::pair<Index, Index>, std::vector<Index>> sides;
    std::set<Index> used;
    for (std::size_t t = 0; t < all.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const Index p = all[t][k], q = all[t][(k + 1) % 3];
        sides[{std::min(p, q), std::max(p, q)}].push_back(Index(t));
        used.insert(p);
      }
    vertices.assign(used.begin(), used.end());
    for (const auto& [ends, faces] : sides) edges.push_back({ends.first, ends.second, faces});
  }
  Vec3 at(Index node) const { return x->segment<3>(3 * Eigen::Index(node)); }
  Vec3 normal(Index t) const {
    const auto& c = triangles[t];
    return (at(c[1]) - at(c[0])).cross(at(c[2]) - at(c[0])).normalized();
  }
  Vec3 vertex_normal(Index node) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int k = 0; k < 3; ++k)
        if (triangles[t][k] == node) {
          const Vec3 u = (at(triangles[t][(k + 1) % 3]) - at(node)).normalized();
          const Vec3 v = (at(triangles[t][(k + 2) % 3]) - at(node)).normalized();
          sum += std::acos(std::clamp(u.dot(v), -1.0, 1.0)) * normal(Index(t));
        }
    return sum.normalized();
  }
  Index third(Index t, const Edge& e) const {
    for (const Index v : triangles[t])
      if (v != e.p && v != e.q) return v;
    return -1;
  }
  std::vector<Index> neighbours(Index node) const {
    std::vector<Index> all;
    for (const Edge& e : edges) {
      if (e.p == node) all.push_back(e.q);
      if (e.q == node) all.push_back(e.p);
    }
    return all;
  }

  std::vector<Triangle> triangles;
  const Eigen::VectorXd* x;
  std::vector<Index> vertices;
  std::vector<Edge> edges;
};

struct BrutePair {
  Index feature_a, feature_b;
  double gap;
  Vec3 normal, point_b;
};

struct BruteFoot {
  Index feature;
  double gap;
  Vec3 normal, point;
};

/// Faces beside which `p` lies by no more than `beside`, as if it lay over them.
inline void add_faces_beside(const BruteSurface& s, const Vec3& p, double beside,
                             std::vector<BruteFoot>& feet) {
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const auto& c = s.triangles[t];
    const Vec3 normal = s.normal(Index(t));
    const double height = (p - s.at(c[0])).dot(normal);
    const Vec3 foot = p - height * normal;
    Vec3 best = Vec3::Constant(1e9);
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      const Vec3 from = s.at(c[k]), along = s.at(c[(k + 1) % 3]) - from;
      inside = inside && normal.cross(along).dot(foot - from) > 0;
      const Vec3 near =
          from + std::clamp((foot - from).dot(along) / along.squaredNorm(), 0.0, 1.0) * along;
      if ((near - foot).norm() < (best - foot).norm()) best = near;
    }
    if (!inside && (best - foot).norm() <= beside)
      feet.push_back({Index(s.vertices.size() + s.edges.size() + t), height, normal, best});
  }
}

/// Every feature of `s` at which the distance to `p` has a local minimum, the nearest first.
inline std::vector<BruteFoot> brute_feet(const BruteSurface& s, const Vec3& p, double beside = -1) {
  std::vector<BruteFoot> feet;
  const auto add = [&](std::size_t feature, const Vec3& q, const Vec3& outward) {
    const double distance = (p - q).norm();
    const double gap = (p - q).dot(outward) < 0 ? -distance : distance;
    feet.push_back({Index(feature), gap, (p - q) / gap, q});
  };
  const std::size_t vertex_count = s.vertices.size(), edge_count = s.edges.size();
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const auto& c = s.triangles[t];
    Mat3 system;
    system << s.at(c[1]) - s.at(c[0]), s.at(c[2]) - s.at(c[0]), s.normal(Index(t));
    const Vec3 solved = system.fullPivLu().solve(p - s.at(c[0]));
    if (solved[0] > 0 && solved[1] > 0 && solved[0] + solved[1] < 1)
      add(vertex_count + edge_count + t, p - solved[2] * s.normal(Index(t)), s.normal(Index(t)));
  }
  for (std::size_t e = 0; e < edge_count; ++e) {
    const auto& edge = s.edges[e];
    const Vec3 along = s.at(edge.q) - s.at(edge.p);
    const double t = (p - s.at(edge.p)).dot(along) / along.squaredNorm();
    if (!(t > 0 && t < 1)) continue;
    const Vec3 q = s.at(edge.p) + t * along;
    bool least = true;
    Vec3 outward = Vec3::Zero();
    for (const Index face : edge.faces) {
      Vec3 inward = s.normal(face).cross(along);
      if (inward.dot(s.at(s.third(face, edge)) - s.at(edge.p)) < 0) inward = -inward;
      least = least && inward.dot(p - q) <= 0;
      outward += s.normal(face);
    }
    if (least) add(vertex_count + e, q, outward);
  }
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const Vec3 q = s.at(s.vertices[v]);
    bool least = true;
    for (const Index next : s.neighbours(s.vertices[v]))
      least = least && (s.at(next) - q).dot(p - q) <= 0;
    if (least) add(v, q, s.vertex_normal(s.vertices[v]));
  }
  if (beside >= 0) add_faces_beside(s, p, beside, feet);
  std::ranges::sort(feet, {}, [](const BruteFoot& f) { return std::abs(f.gap); });
  return feet;
}

/// How often the surface winds around `p`: its solid angles over 4 pi.
inline double brute_winding(const BruteSurface& s, const Vec3& p) {
  double sum = 0;
  for (const auto& c : s.triangles) {
    const Vec3 a = (s.at(c[0]) - p).normalized(), b = (s.at(c[1]) - p).normalized(),
               d = (s.at(c[2]) - p).normalized();
    sum += 2 * std::atan2(a.dot(b.cross(d)), 1 + a.dot(b) + b.dot(d) + d.dot(a));
  }
  return sum / (4 * M_PI);
}

inline void brute_vertices(const BruteSurface& x, const BruteSurface& y, bool flipped, double alarm,
                           double reach, std::vector<BrutePair>& out) {
  for (std::size_t v = 0; v < x.vertices.size(); ++v) {
    const Vec3 p = x.at(x.vertices[v]), own = x.vertex_normal(x.vertices[v]);
    const double beside = 0.02 * alarm;
    const auto feet = brute_feet(y, p, beside);
    const auto on_other_side = [&](const BruteFoot& f) {
      return f.gap < -beside && std::ranges::any_of(feet, [&](const BruteFoot& near) {
               return std::abs(near.gap) <= beside && near.normal.dot(f.normal) < -0.2;
             });
    };
    const auto judge = std::ranges::find_if(feet, [&](const BruteFoot& f) {
      return !on_other_side(f) && (f.gap < 0 || f.gap > beside || f.normal.dot(own) <= 0.3);
    });
    // Of a surface that is folded there, or passes through itself, the nearest foot may be wrong.
    const auto is_doubtful = [&](const BruteFoot& f) {
      return f.gap < -beside && (std::size_t(f.feature) < y.vertices.size() ||
                                 std::ranges::any_of(feet, [&](const BruteFoot& other) {
                                   return other.gap > 0 && std::abs(other.gap + f.gap) <= beside;
                                 }));
    };
    const bool is_inside =
        judge == feet.end() || (judge->gap < 0 && !(is_doubtful(*judge) && brute_winding(y, p) <= 0.1));
    std::vector<BruteFoot> kept;
    if (is_inside) {
      // Near sides that it hardly faces come before deep ones that it faces.
      const auto way_out = [&](double nearest, double farthest, double limit) {
        return std::ranges::find_if(feet, [&](const BruteFoot& f) {
          return f.gap <= beside && std::abs(f.gap) >= nearest && std::abs(f.gap) <= farthest &&
                 f.normal.dot(own) <= limit && !on_other_side(f);
        });
      };
      auto way = way_out(0, alarm, 0.3);
      if (way == feet.end()) way = way_out(0, alarm, 0.55);
      if (way == feet.end()) way = way_out(alarm, 1e9, 0.3);
      if (way != feet.end() && -way->gap <= reach) kept.push_back(*way);
    }
    for (const BruteFoot& foot : feet) {
      if (is_inside) break;
      if (foot.gap < 0 || foot.gap > alarm || foot.normal.dot(own) > 0.3) continue;
      bool least =
          foot.gap <= alarm / 4 && std::size_t(foot.feature) >= y.vertices.size() + y.edges.size();
      if (!least) {
        least = true;
        for (const Index next : x.neighbours(x.vertices[v])) {
          const Vec3 arm = x.at(next) - p;
          least = least && arm.dot(-foot.normal) <= 0.26 * arm.norm();
        }
      }
      const bool known = std::ranges::any_of(
          kept, [&](const BruteFoot& k) { return k.normal.dot(foot.normal) > 0.966; });
      if (least && !known) kept.push_back(foot);
    }
    for (const BruteFoot& foot : kept) {
      if (flipped)
        out.push_back({foot.feature, Index(v), foot.gap, -foot.normal, p});
      else
        out.push_back({Index(v), foot.feature, foot.gap, foot.normal, foot.point});
    }
  }
}

/// Halfway between the outward limits of the cone of an edge: away from the middle of its faces.
inline Vec3 brute_outward(const BruteSurface& s, const BruteSurface::Edge& e) {
  Vec3 sum = Vec3::Zero();
  const Vec3 along = (s.at(e.q) - s.at(e.p)).normalized();
  for (const Index face : e.faces) {
    const Vec3 arm = s.at(s.third(face, e)) - s.at(e.p);
    sum += s.normal(face) - (arm - along * along.dot(arm)).normalized();
  }
  return sum.normalized();
}

/// Convex, and turns by enough to stand out.
inline bool brute_is_ridge(const BruteSurface& s, const BruteSurface::Edge& e) {
  const Vec3 along = (s.at(e.q) - s.at(e.p)).normalized();
  const Vec3 arm = s.at(s.third(e.faces[1], e)) - s.at(e.p);
  const Vec3 inward = (arm - along * along.dot(arm)).normalized();
  const Vec3 n0 = s.normal(e.faces[0]), n1 = s.normal(e.faces[1]);
  return n0.dot(inward) < (n0.dot(n1) < -0.9 ? 0 : -0.05);
}

/// The cone of a convex edge holds `direction`, to the sine given.
inline bool brute_in_cone(const BruteSurface& s, const BruteSurface::Edge& e, const Vec3& direction) {
  const Vec3 along = (s.at(e.q) - s.at(e.p)).normalized();
  std::array<Vec3, 2> inward;
  for (int k = 0; k < 2; ++k) {
    const Vec3 arm = s.at(s.third(e.faces[k], e)) - s.at(e.p);
    inward[k] = (arm - along * along.dot(arm)).normalized();
  }
  if (!brute_is_ridge(s, e)) return false;
  const Vec3 middle = s.normal(e.faces[0]) + s.normal(e.faces[1]) - inward[0] - inward[1];
  return direction.dot(inward[0]) <= 0.02 && direction.dot(inward[1]) <= 0.02 &&
         direction.dot(middle) > 0;
}

inline bool brute_pierces_face(const BruteSurface& x, const BruteSurface::Edge& e,
                               const BruteSurface& y, const Triangle& c) {
  const Vec3 p = x.at(e.p), along = x.at(e.q) - p;
  Mat3 system;
  system << y.at(c[1]) - y.at(c[0]), y.at(c[2]) - y.at(c[0]), -along;
  const Vec3 solved = system.fullPivLu().solve(p - y.at(c[0]));
  return solved[0] > 0 && solved[1] > 0 && solved[0] + solved[1] < 1 && solved[2] > 0 && solved[2] < 1;
}

inline bool brute_pierces(const BruteSurface& x, const BruteSurface::Edge& e, const BruteSurface& y) {
  return std::ranges::any_of(y.triangles,
                             [&](const Triangle& c) { return brute_pierces_face(x, e, y, c); });
}

/// Whether an edge of x pierces a face beside an edge of y.
inline bool brute_cuts_beside(const BruteSurface& x, const BruteSurface::Edge& e, const BruteSurface& y,
                              const BruteSurface::Edge& f) {
  return std::ranges::any_of(
      f.faces, [&](Index face) { return brute_pierces_face(x, e, y, y.triangles[face]); });
}

inline bool brute_inside(const BruteSurface& s, const Vec3& point) {
  return brute_winding(s, point) > 0.5;
}

/// Two edges that have cut right through each other, all of whose ends are outside.
inline bool brute_nick(const BruteSurface& a, const BruteSurface::Edge& e, const BruteSurface& b,
                       const BruteSurface::Edge& f, const Vec3& pa, const Vec3& pb) {
  const auto outward = [](const BruteSurface& s, const BruteSurface::Edge& edge) {
    Vec3 sum = Vec3::Zero();
    for (const Index face : edge.faces) sum += s.normal(face);
    return sum.normalized();
  };
  if (!brute_is_ridge(a, e) && !brute_is_ridge(b, f)) return false;
  if (!brute_cuts_beside(a, e, b, f) || !brute_cuts_beside(b, f, a, e)) return false;
  if (!((pa - pb).dot(outward(b, f) - outward(a, e)) < 0)) return false;
  for (const double share : {0.25, 0.5, 0.75})
    for (const BruteSurface* s : {&a, &b}) {
      const Vec3 place = pb + share * (pa - pb);
      if (!brute_inside(*s, place) ||
          std::abs(brute_feet(*s, place).front().gap) <= 0.005 * (pa - pb).norm())
        return false;
    }
  return !brute_inside(b, a.at(e.p)) && !brute_inside(b, a.at(e.q)) && !brute_inside(a, b.at(f.p)) &&
         !brute_inside(a, b.at(f.q));
}

inline void brute_edges(const BruteSurface& a, const BruteSurface& b, double alarm, double reach,
                        std::vector<BrutePair>& out) {
  for (std::size_t i = 0; i < a.edges.size(); ++i)
    for (std::size_t j = 0; j < b.edges.size(); ++j) {
      const auto &e = a.edges[i], &f = b.edges[j];
      const Vec3 u = a.at(e.q) - a.at(e.p), v = b.at(f.q) - b.at(f.p);
      const Vec3 cross = u.cross(v);
      if (cross.squaredNorm() <= 1e-6 * u.squaredNorm() * v.squaredNorm()) continue;
      Mat3 system;
      system << u, -v, cross.normalized();
      const Vec3 solved = system.fullPivLu().solve(b.at(f.p) - a.at(e.p));
      if (!(solved[0] > 0 && solved[0] < 1 && solved[1] > 0 && solved[1] < 1)) continue;
      const Vec3 pa = a.at(e.p) + solved[0] * u, pb = b.at(f.p) + solved[1] * v;
      bool is_minimum = false;
      for (const double sign : {-1.0, 1.0}) {
        const Vec3 normal = sign * cross.normalized();
        const double gap = -sign * solved[2];
        if (gap > alarm || gap < -reach) continue;
        if (!brute_in_cone(b, f, normal) || !brute_in_cone(a, e, -normal)) continue;
        const Vec3 lens =
            0.5 * (pa + pb) + 0.25 * gap * (brute_outward(a, e) + brute_outward(b, f)).normalized();
        const bool deep = gap < -alarm / 4;
        if (deep && !(brute_pierces(a, e, b) && brute_pierces(b, f, a))) continue;
        if (gap < 0 && !(brute_feet(b, lens).front().gap < 0.15 * gap &&
                         brute_feet(a, lens).front().gap < 0.15 * gap))
          continue;
        is_minimum = true;
        out.push_back({Index(a.vertices.size() + i), Index(b.vertices.size() + j), gap, normal, pb});
      }
      const double depth = (pa - pb).norm();
      if (!is_minimum && depth <= reach && brute_nick(a, e, b, f, pa, pb))
        out.push_back({Index(a.vertices.size() + i), Index(b.vertices.size() + j),
                       (brute_is_ridge(a, e) ? 0 : 0.01 * u.norm()) +
                           (brute_is_ridge(b, f) ? 0 : 0.01 * v.norm()) - depth,
                       (pb - pa) / depth, pb});
    }
}

inline std::vector<BrutePair> brute_minima(const BruteSurface& a, const BruteSurface& b, double alarm,
                                           double reach) {
  std::vector<BrutePair> all;
  brute_vertices(a, b, false, alarm, reach, all);
  brute_vertices(b, a, true, alarm, reach, all);
  brute_edges(a, b, alarm, reach, all);
  const auto by_features = [](const BrutePair& p, const BrutePair& q) {
    return std::tuple(p.feature_a, p.feature_b, p.gap) < std::tuple(q.feature_a, q.feature_b, q.gap);
  };
  std::sort(all.begin(), all.end(), by_features);
  all.erase(std::unique(all.begin(), all.end(),
                        [](const BrutePair& p, const BrutePair& q) {
                          return p.feature_a == q.feature_a && p.feature_b == q.feature_b;
                        }),
            all.end());
  return all;
}

}  // namespace souple::test
