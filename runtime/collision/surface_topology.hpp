// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <span>
#include <vector>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// How the vertices, edges and triangles of a surface hang together. Vertices are numbered 0, 1, ... in
/// the order of the mesh nodes that they are.
struct CollisionTopology {
  struct Edge {
    std::array<Index, 2> vertex{};
    std::array<Index, 2> triangle{-1, -1};  ///< the second is -1 at a border
  };

  CollisionTopology() = default;
  explicit CollisionTopology(std::span<const Triangle> triangles);

  Index vertex_count() const { return static_cast<Index>(nodes.size()); }
  Index edge_count() const { return static_cast<Index>(edges.size()); }
  /// Vertices that an edge joins to `vertex`.
  std::span<const Index> ring(Index vertex) const {
    return {ring_vertices.data() + ring_start[vertex], ring_vertices.data() + ring_start[vertex + 1]};
  }
  /// Triangles at `vertex`, ascending.
  std::span<const Index> fan(Index vertex) const {
    return {fan_triangles.data() + fan_start[vertex], fan_triangles.data() + fan_start[vertex + 1]};
  }
  std::size_t bytes() const;

  std::vector<Index> nodes;                          ///< mesh node of every vertex, ascending
  std::vector<Index> vertex_of_node;                 ///< -1: not on the surface
  std::vector<std::array<Index, 3>> corners;         ///< vertices of every triangle
  std::vector<std::array<Index, 3>> triangle_edges;  ///< edge k from corner k to k + 1
  std::vector<Edge> edges;                           ///< ascending by their vertices
  std::vector<Index> ring_start, ring_vertices, fan_start, fan_triangles;
  std::vector<Index> component;        ///< of every vertex
  std::vector<Index> component_first;  ///< the lowest vertex of every connected part

 private:
  void join_edges();
  void find_rings();
  void find_components();
};

}  // namespace souple
