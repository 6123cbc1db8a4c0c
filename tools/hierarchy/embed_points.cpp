// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/embed_points.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <string>

#include "tools/geometry/triangle_bvh.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/hierarchy/tet_tree.hpp"
#include "tools/hierarchy/tet_weights.hpp"

namespace souple {
namespace {

/// Of the boundary tets about as near as the nearest, the one with the least weights is taken: a point
/// beside a thin tet is better held by its neighbour.
constexpr std::size_t near_triangles = 8;
constexpr double about_as_near = 1.5;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

double largest_of(const std::array<double, 4>& weights) {
  double largest = 0;
  for (const double w : weights) largest = std::max(largest, std::abs(w));
  return largest;
}

/// The boundary of a mesh and the tet behind each of its triangles.
class BoundaryTets {
 public:
  explicit BoundaryTets(const TetMesh& mesh)
      : mesh_(mesh), owners_(boundary_owners(mesh.tets)), bvh_(surface(mesh, owners_)) {}

  /// Extrapolated weights; the distance is that of the nearest boundary triangle.
  Embedding nearest(const Point& p, double& distance) const {
    std::array<ClosestPoint, near_triangles> closest;
    const std::size_t count = bvh_.nearest(p, closest);
    Embedding best;
    double least = std::numeric_limits<double>::infinity();
    const double limit = about_as_near * about_as_near * closest[0].squared_distance;
    for (std::size_t k = 0; k < count; ++k) {
      if (closest[k].squared_distance > limit) break;
      const Index tet = owners_[at(closest[k].triangle)].tet;
      const auto weights = barycentric_weights(p, mesh_.tets[at(tet)], mesh_.nodes);
      const double largest = largest_of(weights);
      if (largest < least || (largest == least && tet < best.tet)) {
        least = largest;
        best = {tet, weights};
      }
    }
    distance = std::sqrt(closest[0].squared_distance);
    return best;
  }

 private:
  struct Owner {
    Triangle triangle;
    Index tet;
  };
  static std::vector<Owner> boundary_owners(const std::vector<Tet>& tets) {
    // boundary_triangles keeps the order of tets, so that the owners are found by walking along.
    std::vector<Owner> owners;
    std::size_t t = 0;
    const auto has = [](const Tet& tet, const Triangle& f) {
      return std::ranges::all_of(f, [&](Index i) { return std::ranges::find(tet, i) != tet.end(); });
    };
    for (const Triangle& f : boundary_triangles(tets)) {
      while (t < tets.size() && !has(tets[t], f)) ++t;
      if (t < tets.size()) owners.push_back({f, static_cast<Index>(t)});
    }
    return owners;
  }
  static TriangleMesh surface(const TetMesh& mesh, const std::vector<Owner>& owners) {
    TriangleMesh surface{mesh.nodes, {}};
    for (const Owner& owner : owners) surface.triangles.push_back(owner.triangle);
    return surface;
  }

  const TetMesh& mesh_;
  std::vector<Owner> owners_;
  TriangleBvh bvh_;
};

}  // namespace

Result<EmbeddedPoints> embed_points(std::span<const Point> points, const TetMesh& mesh) try {
  if (const Status valid = check_tet_mesh(mesh); !valid) return valid.issue();
  const TetTree tree(mesh);
  const BoundaryTets boundary(mesh);
  EmbeddedPoints result;
  result.rows.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_within_reach(points[i]))
      return make_issue(IssueCode::embedding_failed,
                        "point " + std::to_string(i) + " is not finite or too far out");
    Embedding row = tree.containing(points[i]);
    if (row.tet < 0) {
      double distance = 0;
      row = boundary.nearest(points[i], distance);
      ++result.outside_count;
      result.farthest_outside_m = std::max(result.farthest_outside_m, distance);
    }
    const double largest = largest_of(row.weights);
    if (!(largest <= most_embedding_weight))
      return make_issue(IssueCode::embedding_failed, "point " + std::to_string(i) +
                                                         " would have the weight " +
                                                         std::to_string(largest) + "; the limit is " +
                                                         std::to_string(most_embedding_weight));
    result.largest_weight = std::max(result.largest_weight, largest);
    result.rows.push_back(row);
  }
  return result;
} catch (const std::bad_alloc&) {
  return make_issue(IssueCode::embedding_failed, "not enough memory");
}

}  // namespace souple
