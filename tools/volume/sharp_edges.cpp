// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/sharp_edges.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <tuple>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

const double sharp_cosine = std::cos(40 * std::numbers::pi / 180);
const double corner_cosine = std::cos(45 * std::numbers::pi / 180);
constexpr double most_loose_ends = 0.06;
/// Of the nodes, before they crowd out the rest of the mesh.
constexpr double most_feature_nodes = 0.3;
/// Closer than that part of a step, two sharp edges make tets much smaller than asked for.
constexpr double crowded_distance = 0.35, most_crowded = 0.02;
constexpr std::size_t most_samples = 20'000;

struct Edge {
  Index a, b;  ///< a < b
  Index triangle;
};

std::vector<Edge> edges_of(const std::vector<Triangle>& triangles) {
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<Index>(t)});
    }
  std::ranges::sort(edges, [](const Edge& x, const Edge& y) {
    return std::tie(x.a, x.b, x.triangle) < std::tie(y.a, y.b, y.triangle);
  });
  return edges;
}

Point unit_normal(const TriangleMesh& mesh, Index triangle) {
  const Triangle& t = mesh.triangles[static_cast<std::size_t>(triangle)];
  const auto x = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
  const Point n = cross(subtract(x(1), x(0)), subtract(x(2), x(0)));
  const double length = norm(n);
  return length > 0 ? scaled(n, 1 / length) : n;
}

/// The graph of sharp edges, walked chain by chain.
class Chains {
 public:
  Chains(const std::vector<Point>& points, const std::vector<std::array<Index, 2>>& edges)
      : points_(points), edges_(edges), at_(points.size()), used_(edges.size(), false) {
    for (std::size_t e = 0; e < edges.size(); ++e)
      for (const Index v : edges[e]) at_[static_cast<std::size_t>(v)].push_back(e);
  }

  double loose_ends() const {
    const auto touched = std::ranges::count_if(at_, [](const auto& e) { return !e.empty(); });
    const auto loose = std::ranges::count_if(at_, [](const auto& e) { return e.size() == 1; });
    return touched > 0 ? static_cast<double>(loose) / static_cast<double>(touched) : 0;
  }

  std::vector<std::vector<Point>> walk() {
    std::vector<std::vector<Point>> chains;
    // First from the corners; what is left then are loops without a corner.
    for (const bool from_corners : {true, false})
      for (std::size_t v = 0; v < at_.size(); ++v) {
        if (at_[v].empty() || is_corner(v) != from_corners) continue;
        for (const std::size_t e : at_[v])
          if (!used_[e]) chains.push_back(chain_from(v, e));
      }
    return chains;
  }

 private:
  std::size_t other_end(std::size_t e, std::size_t v) const {
    const auto a = static_cast<std::size_t>(edges_[e][0]), b = static_cast<std::size_t>(edges_[e][1]);
    return v == a ? b : a;
  }

  bool is_corner(std::size_t v) const {
    if (at_[v].size() != 2) return true;
    const Point in = subtract(points_[v], points_[other_end(at_[v][0], v)]);
    const Point out = subtract(points_[other_end(at_[v][1], v)], points_[v]);
    return dot(in, out) < corner_cosine * norm(in) * norm(out);
  }

  std::vector<Point> chain_from(std::size_t start, std::size_t e) {
    std::vector<Point> chain{points_[start]};
    for (std::size_t v = start;;) {
      used_[e] = true;
      v = other_end(e, v);
      chain.push_back(points_[v]);
      if (v == start || is_corner(v)) return chain;
      const std::size_t next = at_[v][0] == e ? at_[v][1] : at_[v][0];
      if (used_[next]) return chain;
      e = next;
    }
  }

  const std::vector<Point>& points_;
  const std::vector<std::array<Index, 2>>& edges_;
  std::vector<std::vector<std::size_t>> at_;  ///< sharp edges at a vertex
  std::vector<bool> used_;
};

struct Sample {
  Point point;
  std::size_t chain;
  double from_start, to_end;  ///< along the chain
};

std::vector<Sample> samples_of(const SharpEdges& edges, double spacing) {
  std::vector<Sample> samples;
  for (std::size_t c = 0; c < edges.polylines.size(); ++c) {
    const std::vector<Point>& line = edges.polylines[c];
    const std::size_t first = samples.size();
    double along = 0;
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Point d = subtract(line[i], line[i - 1]);
      const double length = norm(d);
      const auto parts = static_cast<std::size_t>(std::clamp(std::ceil(length / spacing), 1.0, 1e4));
      for (std::size_t k = 0; k < parts; ++k) {
        const double part = (static_cast<double>(k) + 0.5) / static_cast<double>(parts);
        samples.push_back({add_scaled(line[i - 1], part, d), c, along + part * length, 0});
      }
      along += length;
    }
    for (std::size_t s = first; s < samples.size(); ++s)
      samples[s].to_end = along - samples[s].from_start;
  }
  return samples;
}

/// Near in space but far along the edges: not neighbours on a chain, nor on two chains at their corner.
bool crowd(const Sample& a, const Sample& b, double distance) {
  const double away = norm(subtract(a.point, b.point));
  if (away >= distance) return false;
  if (a.chain == b.chain) {
    const double along = std::abs(a.from_start - b.from_start);
    return std::min(along, a.from_start + a.to_end - along) > 3 * distance;
  }
  const double to_corner = std::max(std::min(a.from_start, a.to_end), std::min(b.from_start, b.to_end));
  return to_corner > 3 * distance;
}

std::string text(const char* format, double value) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

}  // namespace

SharpEdges find_sharp_edges(const TriangleMesh& surface) {
  SharpEdges found;
  double whole = 0;
  std::vector<std::array<Index, 2>> sharp;
  const std::vector<Edge> edges = edges_of(surface.triangles);
  for (std::size_t first = 0, last; first < edges.size(); first = last) {
    const Edge& e = edges[first];
    for (last = first; last < edges.size() && edges[last].a == e.a && edges[last].b == e.b;) ++last;
    const double length = norm(subtract(surface.vertices[static_cast<std::size_t>(e.a)],
                                        surface.vertices[static_cast<std::size_t>(e.b)]));
    whole += length;
    // Rounding to the grid may have taken a neighbour's area away.
    if (last - first != 2) continue;
    if (dot(unit_normal(surface, e.triangle), unit_normal(surface, edges[first + 1].triangle)) >=
        sharp_cosine)
      continue;
    sharp.push_back({e.a, e.b});
    found.length += length;
  }
  found.count = sharp.size();
  found.length_share = whole > 0 ? found.length / whole : 0;
  Chains chains(surface.vertices, sharp);
  found.loose_ends = chains.loose_ends();
  found.polylines = chains.walk();
  return found;
}

double crowded_share(const SharpEdges& edges, double distance) {
  const double spacing = std::max(distance / 2, edges.length / static_cast<double>(most_samples));
  std::vector<Sample> samples = samples_of(edges, spacing);
  if (samples.empty()) return 0;
  std::ranges::sort(samples, {}, [](const Sample& s) { return s.point; });
  std::vector<bool> crowded(samples.size(), false);
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t k = i + 1;
         k < samples.size() && samples[k].point[0] - samples[i].point[0] < distance; ++k)
      if (crowd(samples[i], samples[k], distance)) crowded[i] = crowded[k] = true;
  return static_cast<double>(std::ranges::count(crowded, true)) / static_cast<double>(samples.size());
}

FeatureReport decide_on_features(const SharpEdges& edges, FeatureMode mode, double step,
                                 double node_count) {
  FeatureReport report{edges.count, edges.length_share, false, {}};
  const double share = edges.length / step / node_count;
  if (edges.count == 0) {
    report.reason = "no edge turns by more than 40 degrees";
  } else if (mode == FeatureMode::ignore) {
    report.reason = "not asked for";
  } else if (mode == FeatureMode::keep) {
    report.kept = true;
    report.reason = "asked for";
  } else if (edges.loose_ends > most_loose_ends) {
    report.reason = text(
        "sharp edges end in smooth places at %.0f %% of their vertices: organic shape or "
        "scan",
        100 * edges.loose_ends);
  } else if (share > most_feature_nodes) {
    report.reason =
        text("the sharp edges alone would take %.0f %% of the nodes at this size", 100 * share);
  } else if (const double crowded = crowded_share(edges, crowded_distance * step);
             crowded > most_crowded) {
    report.reason =
        text("%.0f %% of the sharp edges run closer together than a tet of this size", 100 * crowded);
  } else {
    report.kept = true;
    report.reason = "sharp edges run from corner to corner or in loops: machine part";
  }
  return report;
}

}  // namespace souple
