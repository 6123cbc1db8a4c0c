// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// The boundary of a level as a surface of its own: vertices are its nodes in ascending order.
struct LevelSurface {
  LevelSurface(const TetMesh& mesh, const std::vector<Triangle>& boundary);

  std::vector<Index> nodes;         ///< of the level, one per vertex
  std::vector<Index> vertex_of;     ///< of every node of the level; -1 inside
  std::vector<Triangle> triangles;  ///< of vertices

  std::span<const Index> triangles_of(std::size_t vertex) const {
    return {around_.data() + first_[vertex], first_[vertex + 1] - first_[vertex]};
  }
  std::vector<Point> positions(const TetMesh& mesh) const;
  /// Unit normals weighted by area; zero where the triangles cancel out.
  std::vector<Point> vertex_normals(const std::vector<Point>& positions) const;
  Point vertex_normal(const std::vector<Point>& positions, std::size_t vertex) const;
  /// Longest edge at a vertex, m.
  double reach(const std::vector<Point>& positions, std::size_t vertex) const;

 private:
  std::vector<std::size_t> first_;
  std::vector<Index> around_;
};

/// Outward, as long as twice the area.
Point area_vector(const Triangle& triangle, const std::vector<Point>& positions);

}  // namespace souple
