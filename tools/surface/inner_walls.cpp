// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/inner_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/surface/shells.hpp"

namespace souple {
namespace {

/// Radians; sheets closer than this at a common edge lie on each other.
constexpr double least_angle = 1e-6;
/// Share of the area around a chamber that faces into it if it is a cavity.
constexpr double cavity_share = 0.99;
/// Of the unit cubed; below it a chamber is a gap between walls.
constexpr double least_volume = 1e-12;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Both sides of every triangle, 2 t in front (where its normal points) and 2 t + 1 behind, in groups.
class Sides {
 public:
  explicit Sides(std::size_t triangle_count) : group_(2 * triangle_count) {
    std::iota(group_.begin(), group_.end(), std::size_t{0});
  }
  std::size_t of(std::size_t side) {
    while (group_[side] != side) side = group_[side] = group_[group_[side]];
    return side;
  }
  void join(std::size_t a, std::size_t b) { group_[std::max(of(a), of(b))] = std::min(of(a), of(b)); }

 private:
  std::vector<std::size_t> group_;
};

/// A triangle at an edge from a lower to a higher vertex.
struct Flap {
  std::array<Index, 2> edge;
  std::size_t triangle = 0;
  Index tip = 0;
  bool is_along = false;  ///< runs through the edge upwards
  double angle = 0;       ///< about the edge, counter-clockwise
};

std::vector<Flap> flaps_of(const std::vector<Triangle>& triangles) {
  std::vector<Flap> flaps;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      flaps.push_back({{std::min(a, b), std::max(a, b)}, t, triangles[t][(k + 2) % 3], a < b});
    }
  std::ranges::sort(flaps, {}, [](const Flap& f) { return std::pair(f.edge, f.triangle); });
  return flaps;
}

void measure_angles(const std::vector<Point>& points, Flap* first, Flap* last) {
  const Point& origin = points[at(first->edge[0])];
  const Point axis = subtract(points[at(first->edge[1])], origin);
  const auto across = [&](const Flap& f) {
    const Point v = subtract(points[at(f.tip)], origin);
    return add_scaled(v, -dot(v, axis) / squared_norm(axis), axis);
  };
  const Point u = across(*first);
  const Point w = cross(scaled(axis, 1 / norm(axis)), u);
  for (Flap* f = first; f != last; ++f) {
    const Point v = across(*f);
    f->angle = std::atan2(dot(v, w), dot(v, u));
    if (f->angle < least_angle - std::numbers::pi) f->angle += 2 * std::numbers::pi;
  }
}

/// With the edge pointing at the eye, a triangle that runs along it has its front counter-clockwise.
std::size_t side_counter_clockwise(const Flap& f) { return 2 * f.triangle + (f.is_along ? 0 : 1); }
std::size_t side_clockwise(const Flap& f) { return 2 * f.triangle + (f.is_along ? 1 : 0); }

/// Of two sheets that lie on each other, the walls of two solids, the fronts shall face: a gap without
/// width is between them. False if there are more, or both face the same way.
bool order_coincident(Flap* first, Flap* last) {
  for (Flap* f = first; f + 1 < last; ++f) {
    if (f[1].angle - f->angle > least_angle) continue;
    if (f->is_along == f[1].is_along) return false;
    if (!f->is_along) std::swap(*f, f[1]);
    if (f + 2 < last && f[2].angle - f->angle <= 2 * least_angle) return false;
    ++f;
  }
  return last[-1].angle - first->angle < 2 * std::numbers::pi - least_angle;
}

/// Joins the sides that face each other about one edge; false if that cannot be told.
bool join_about_edge(const std::vector<Point>& points, Flap* first, Flap* last, Sides& sides) {
  if (last - first < 2) return false;
  measure_angles(points, first, last);
  std::sort(first, last, [](const Flap& a, const Flap& b) { return a.angle < b.angle; });
  if (!order_coincident(first, last)) return false;
  for (Flap* f = first; f != last; ++f)
    sides.join(side_counter_clockwise(*f), side_clockwise(f + 1 == last ? *first : f[1]));
  return true;
}

bool join_about_edges(const TriangleMesh& mesh, Sides& sides) {
  std::vector<Flap> flaps = flaps_of(mesh.triangles);
  for (std::size_t i = 0, j = 0; i < flaps.size(); i = j) {
    while (j < flaps.size() && flaps[j].edge == flaps[i].edge) ++j;
    if (!join_about_edge(mesh.vertices, &flaps[i], flaps.data() + j, sides)) return false;
  }
  return true;
}

/// What lies between sides; the outside has a negative volume.
struct Chamber {
  double volume = 0;
  double area = 0, facing_in = 0;
};

std::vector<Chamber> measure_chambers(const TriangleMesh& mesh, Sides& sides) {
  std::vector<Chamber> chambers(2 * mesh.triangles.size());  // by group
  const Box box = bounding_box(mesh.vertices);
  const Point middle = scaled(add(box.low, box.high), 0.5);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Point, 3> p;
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = subtract(mesh.vertices[at(mesh.triangles[t][k])], middle);
    const double volume = dot(p[0], cross(p[1], p[2])) / 6;
    const double area = norm(cross(subtract(p[1], p[0]), subtract(p[2], p[0]))) / 2;
    Chamber &front = chambers[sides.of(2 * t)], &back = chambers[sides.of(2 * t + 1)];
    back.volume += volume;
    front.volume -= volume;
    back.area += area;
    front.area += area;
    front.facing_in += area;
  }
  return chambers;
}

/// Which groups are solid; nothing if that cannot be told.
std::optional<std::vector<bool>> find_solids(const std::vector<Chamber>& chambers) {
  std::vector<bool> solid(chambers.size(), false);
  const auto is_outside = [](const Chamber& c) { return c.area > 0 && c.volume < -least_volume; };
  if (std::ranges::count_if(chambers, is_outside) != 1) return std::nullopt;
  // A piece may be inside out as a whole.
  const Chamber& outside = *std::ranges::find_if(chambers, is_outside);
  const bool is_inverted = outside.facing_in < outside.area / 2;
  for (std::size_t c = 0; c < chambers.size(); ++c) {
    const Chamber& chamber = chambers[c];
    if (chamber.area == 0 || is_outside(chamber)) continue;
    const double facing_in = is_inverted ? chamber.area - chamber.facing_in : chamber.facing_in;
    solid[c] = chamber.volume < least_volume || facing_in < cavity_share * chamber.area;
  }
  return solid;
}

std::optional<TriangleMesh> without_inner_walls(const TriangleMesh& piece) {
  Sides sides(piece.triangles.size());
  if (!join_about_edges(piece, sides)) return std::nullopt;
  const auto solid = find_solids(measure_chambers(piece, sides));
  if (!solid) return std::nullopt;
  TriangleMesh rest{piece.vertices, {}};
  for (std::size_t t = 0; t < piece.triangles.size(); ++t) {
    const bool front = (*solid)[sides.of(2 * t)], back = (*solid)[sides.of(2 * t + 1)];
    if (!front && !back) return std::nullopt;  // a sheet, or nothing between the outside and a cavity
    if (front && back) continue;
    const Triangle& own = piece.triangles[t];
    rest.triangles.push_back(back ? own : Triangle{own[0], own[2], own[1]});
  }
  return rest;
}

bool has_crowded_edges(const TriangleMesh& piece) {
  const SurfaceTopology topology = measure_topology(piece.triangles, piece.vertices.size());
  return topology.boundary_edge_count == 0 && topology.nonmanifold_edge_count > 0;
}

}  // namespace

MendStep drop_inner_walls(const TriangleMesh& mesh) {
  std::vector<TriangleMesh> pieces;
  std::size_t removed = 0;
  for (Shell& shell : split_into_shells(mesh, {})) {
    std::optional<TriangleMesh> rest;
    if (has_crowded_edges(shell.mesh)) rest = without_inner_walls(shell.mesh);
    if (rest) removed += shell.mesh.triangles.size() - rest->triangles.size();
    pieces.push_back(rest ? std::move(*rest) : std::move(shell.mesh));
  }
  if (removed == 0) return {mesh, 0};
  return {in_canonical_order(join_meshes(pieces)), removed};
}

}  // namespace souple
