// SPDX-License-Identifier: MIT
// When a pair of features is a local minimum of distance: tests on single pairs.
#pragma once
#include <array>
#include <optional>

#include "runtime/collision/surface_tree.hpp"

namespace souple {

// A pair whose normals point the same way joins the back of a thin part to the front of another.
inline constexpr double same_side_cosine = 0.3;
// A vertex that has entered by a side that it hardly faces; its own sides, at the corner of a box, make
// 0.58 with its normal.
inline constexpr double grazing_cosine = 0.55;
// Normals of two sides of a thin part, rather than of sides that meet at an edge.
inline constexpr double other_side_cosine = -0.2;
// To which part of its rest distance a surface may enter itself.
inline constexpr double self_depth_part = 0.25;
// Nearest among its neighbours: none is nearer by more than this part of its distance (15 degrees).
inline constexpr double vertex_cone_slack = 0.26;
// Of the alarm distance: nearer than this a vertex over a face counts even if its neighbours are
// nearer.
inline constexpr double sure_part = 0.25;
// Of the alarm distance: how far a vertex may lie beside a face and still be over it.
inline constexpr double beside_part = 0.02;
// Minima of a vertex in directions closer than this (15 degrees) are one.
inline constexpr double merging_cosine = 0.966;
// Two edges that penetrate have what both bodies cover between them, so deep below either surface, of
// the depth by which they penetrate. Edges of different sides have not.
inline constexpr double lens_part = 0.15;
// Between two edges that have cut through each other, from one to the other: places that both bodies
// cover.
inline constexpr std::array<double, 3> between_edges = {0.25, 0.5, 0.75};
// Of the depth of the cut: flush sides overlap by less than so much of it.
inline constexpr double thin_part = 0.005;
// Of the cones of edges, sine.
inline constexpr double edge_cone_slack = 0.02;
// Edges that turn by less, as the sine of the angle between their faces, stand out by less than 1 % of
// their length: what they touch, vertices touch as well.
inline constexpr double least_ridge = 0.05;
inline constexpr double flat_part = 0.01;

/// A feature of a surface at which the distance to a point has a local minimum.
struct PointMinimum {
  Index feature = 0;  ///< as SurfaceTree numbers them
  Index triangle = 0;
  ClosestOnTriangle closest;
  Vec3 normal = Vec3::UnitZ();  ///< outward, unit
  double gap = 0;               ///< < 0: the point is behind the surface there
};

/// What one triangle has to say about a point, without order.
struct PointMinima {
  int count = 0;
  std::array<PointMinimum, 2> found;
};

/// The point of `triangle` nearest to `point`, if that is within `radius`:
/// - if no neighbouring triangle comes nearer still, as a local minimum;
/// - if the point lies beside the face by no more than `beside`, as if it lay over the face. Without
///   that, bodies with flush sides would lose each other: a corner in the plane of a side is nearest to
///   the side only, however deep it is below the top.
PointMinima point_minima(const DeformedSurface& surface, Index triangle, const Vec3& point,
                         double radius, double beside);

struct SurfacePoint;
/// The corners that carry weight: 1, 2 or 3 mesh nodes.
SurfacePoint surface_point(const DeformedSurface& surface, const PointMinimum& minimum);

/// How often the surface winds around a point: 1 inside, 0 outside, whatever folds it has near the
/// point (Jacobson et al. 2013; van Oosterom and Strackee 1983). Visits every triangle.
double winding_number(const DeformedSurface& surface, const Vec3& point);
/// Pseudo-normals tell inside from outside, but for a surface that is folded at a vertex: one that is
/// nearest to a point inside is rare enough to look twice.
inline bool is_doubtful(const ClosestOnTriangle& nearest) { return nearest.feature < 3; }

/// How deep a point lies inside, by the pseudo-normal of the nearest feature, however far that is; 0:
/// outside. An empty surface has no inside.
double depth_inside(const DeformedSurface& surface, const Vec3& point);
inline bool is_inside(const DeformedSurface& surface, const Vec3& point) {
  return depth_inside(surface, point) > 0;
}

/// Whether no neighbour of `vertex` lies farther along `direction` (unit) than the slack allows.
bool in_vertex_cone(const DeformedSurface& surface, Index vertex, const Vec3& direction, double slack);

/// A convex edge with its cone of normals.
struct Ridge {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  std::array<Vec3, 2> inward;    ///< unit, in the faces, square to the edge
  Vec3 outward = Vec3::UnitZ();  ///< unit, between the normals of the faces
};

/// Nothing if the edge is concave, or turns by too little to stand out.
std::optional<Ridge> ridge_of(const DeformedSurface& surface, Index edge);
/// The same from its ends, a point of each face beside it and their unit normals.
std::optional<Ridge> make_ridge(const Vec3& from, const Vec3& to, const Vec3& beside1,
                                const Vec3& normal1, const Vec3& beside2, const Vec3& normal2);

struct EdgeMinimum {
  double along_a = 0, along_b = 0;  ///< from the first end, in (0, 1)
  Vec3 normal = Vec3::UnitZ();      ///< unit, from B to A
  double gap = 0;
};

/// The pair of points where the lines of two edges cross, if both lie inside the edges; the normal
/// leaves B rather than A.
std::optional<EdgeMinimum> edge_crossing(const Ridge& a, const Ridge& b);

/// The same, if the normal is in the cones of both.
std::optional<EdgeMinimum> edge_minimum(const Ridge& a, const Ridge& b);

/// A point well inside what two penetrating edges both cover.
inline Vec3 lens_point(const Ridge& a, const Ridge& b, const EdgeMinimum& found) {
  const Vec3 p = a.from + found.along_a * (a.to - a.from), q = b.from + found.along_b * (b.to - b.from);
  return 0.5 * (p + q) + 0.25 * found.gap * (a.outward + b.outward).normalized();
}

/// Where the segment crosses the triangle: both strictly inside.
bool pierces(const Vec3& from, const Vec3& to, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace souple
