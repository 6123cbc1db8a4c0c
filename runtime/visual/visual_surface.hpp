// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// A surface to be shown, bound to the nodes of the simulated mesh: const, shared by all instances.
class VisualSurface {
 public:
  /// Checks every index and weight. `tets` and `node_count` are those of the simulated mesh.
  /// Issues: asset_embedding_invalid, asset_index_out_of_range.
  static Result<VisualSurface> create(const VisualMesh& visual, std::span<const Tet> tets,
                                      std::size_t node_count);

  std::size_t vertex_count() const { return bindings_.size(); }
  std::span<const Triangle> triangles() const { return triangles_; }
  std::size_t bytes() const;

  /// Positions of the vertices (m) for these positions of the nodes, as World::positions gives them.
  /// Exact for affine motions, allocates nothing. False, and nothing is written, unless there is one
  /// entry for every node and one for every vertex. The map is linear: velocities work as well.
  bool positions(std::span<const Point> nodes, std::span<Point> vertices) const;

 private:
  struct Binding {
    Tet nodes;
    std::array<double, 4> weights;
  };

  VisualSurface() = default;

  std::size_t node_count_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<Binding> bindings_;
};

}  // namespace souple
