// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <span>

#include "formats/core/embedding.hpp"
#include "formats/core/limits.hpp"
#include "formats/read/internal/check_rows.hpp"
#include "formats/read/internal/checks.hpp"

namespace souple::checks {
namespace {

// Distance that an embedding may miss its point by, over the longest side of the body.
constexpr double place_tolerance = 1e-6;

std::string weights_text(const Embedding& row) {
  std::string text;
  for (const double weight : row.weights) text += (text.empty() ? "" : ", ") + std::to_string(weight);
  return text;
}

double longest_side(const std::vector<Point>& points) {
  double longest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [low, high] =
        std::ranges::minmax(points, {}, [axis](const Point& point) { return point[axis]; });
    longest = std::max(longest, high[axis] - low[axis]);
  }
  return longest;
}

double distance(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Every row against its point; `size_m` is the longest side of the body.
void check_places(const std::vector<Embedding>& rows, const std::vector<Point>& points,
                  const TetMesh& mesh, double size_m, const std::string& where, IssueList& issues) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Tet& tet = mesh.tets[static_cast<std::size_t>(rows[r].tet)];
    const double miss = distance(embedded_point(tet, rows[r].weights, mesh.nodes), points[r]);
    if (!(miss <= place_tolerance * size_m))
      issues.add(IssueCode::asset_embedding_displaced, where, [&] {
        return "row " + std::to_string(r) + " misses its point by " + std::to_string(miss / size_m) +
               " of the longest side";
      });
  }
}

}  // namespace

void check_embedding(const std::vector<Embedding>& rows, std::size_t point_count, std::size_t tet_count,
                     const std::string& where, IssueList& issues) {
  if (rows.size() != point_count)
    return issues.add(IssueCode::asset_embedding_invalid, where, [&] {
      return std::to_string(rows.size()) + " rows of the embedding, not " + std::to_string(point_count);
    });
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Embedding& row = rows[r];
    if (row.tet < 0 || static_cast<std::size_t>(row.tet) >= tet_count)
      issues.add(IssueCode::asset_index_out_of_range, where, [&] {
        return "row " + std::to_string(r) + " of the embedding names tet " + std::to_string(row.tet) +
               " of " + std::to_string(tet_count);
      });
    if (!has_sound_weights(row.weights))
      issues.add(IssueCode::asset_embedding_invalid, where, [&] {
        return "row " + std::to_string(r) + " of the embedding has the weights " + weights_text(row);
      });
  }
}

void check_level_places(const MeshLevel& coarse, const MeshLevel& fine, const std::string& where,
                        IssueList& issues) {
  check_places(fine.embedding, fine.mesh.nodes, coarse.mesh, longest_side(fine.mesh.nodes), where,
               issues);
}

void check_visual(const VisualMesh& visual, std::size_t tet_count, const std::string& where,
                  IssueList& issues) {
  const auto& [vertices, triangles] = visual.surface;
  if (vertices.empty() && triangles.empty() && visual.embedding.empty()) return;
  if (vertices.empty() || triangles.empty())
    return issues.add(IssueCode::asset_visual_invalid, where, [&] {
      return std::to_string(vertices.size()) + " vertices and " + std::to_string(triangles.size()) +
             " triangles";
    });
  if (vertices.size() > limits::nodes || triangles.size() > limits::triangles)
    return issues.add(IssueCode::asset_limit_exceeded, where,
                      [] { return "too many vertices or triangles"; });
  check_coordinates(vertices, where, "vertex", issues);
  check_range(triangles, vertices.size(), where, "triangle", "vertex", issues);
  check_embedding(visual.embedding, vertices.size(), tet_count, where, issues);
}

void check_visual_places(const VisualMesh& visual, const TetMesh& finest, const std::string& where,
                         IssueList& issues) {
  check_places(visual.embedding, visual.surface.vertices, finest, longest_side(finest.nodes), where,
               issues);
}

}  // namespace souple::checks
