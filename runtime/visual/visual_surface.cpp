// SPDX-License-Identifier: MIT
#include "runtime/visual/visual_surface.hpp"

#include <algorithm>
#include <cmath>

#include "formats/core/embedding.hpp"

namespace souple {
namespace {

constexpr const char* where = "mesh/visual";

template <class Row>
bool names_only(const Row& row, std::size_t count) {
  return std::ranges::all_of(row,
                             [&](Index i) { return i >= 0 && static_cast<std::size_t>(i) < count; });
}

Issue out_of_range(const char* kind, std::size_t row) {
  return make_issue(IssueCode::asset_index_out_of_range,
                    std::string(kind) + " " + std::to_string(row) + " names what does not exist",
                    where);
}

}  // namespace

Result<VisualSurface> VisualSurface::create(const VisualMesh& visual, std::span<const Tet> tets,
                                            std::size_t node_count) {
  if (visual.embedding.size() != visual.surface.vertices.size())
    return make_issue(IssueCode::asset_embedding_invalid,
                      std::to_string(visual.embedding.size()) + " rows for " +
                          std::to_string(visual.surface.vertices.size()) + " vertices",
                      where);
  VisualSurface surface;
  surface.node_count_ = node_count;
  surface.triangles_ = visual.surface.triangles;
  for (std::size_t t = 0; t < surface.triangles_.size(); ++t)
    if (!names_only(surface.triangles_[t], visual.surface.vertices.size()))
      return out_of_range("triangle", t);
  surface.bindings_.reserve(visual.embedding.size());
  for (std::size_t v = 0; v < visual.embedding.size(); ++v) {
    const Embedding& row = visual.embedding[v];
    if (row.tet < 0 || static_cast<std::size_t>(row.tet) >= tets.size() ||
        !names_only(tets[static_cast<std::size_t>(row.tet)], node_count))
      return out_of_range("the embedding of vertex", v);
    if (!std::ranges::all_of(row.weights, [](double w) { return std::isfinite(w); }))
      return make_issue(IssueCode::asset_embedding_invalid,
                        "a weight of vertex " + std::to_string(v) + " is not finite", where);
    surface.bindings_.push_back({tets[static_cast<std::size_t>(row.tet)], row.weights});
  }
  return surface;
}

bool VisualSurface::positions(std::span<const Point> nodes, std::span<Point> vertices) const {
  if (nodes.size() != node_count_ || vertices.size() != bindings_.size()) return false;
  for (std::size_t v = 0; v < vertices.size(); ++v)
    vertices[v] = embedded_point(bindings_[v].nodes, bindings_[v].weights, nodes);
  return true;
}

std::size_t VisualSurface::bytes() const {
  return triangles_.size() * sizeof(Triangle) + bindings_.size() * sizeof(Binding);
}

}  // namespace souple
