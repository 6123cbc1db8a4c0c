// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <map>

#include "formats/core/mesh.hpp"
#include "tools/geometry/unit_frame.hpp"

namespace souple {

/// Triangles at unit size, merged by position, without degenerate and repeated ones, and the way back.
class UnitSoup {
 public:
  /// The extent must be positive.
  explicit UnitSoup(const TriangleMesh& surface);

  const TriangleMesh& mesh() const { return mesh_; }
  double length_m() const { return frame_.length_m(); }
  std::size_t merged_vertex_count() const { return merged_vertex_count_; }
  std::size_t dropped_triangle_count() const { return dropped_triangle_count_; }

  /// Vertices that stand where one of the input was get its exact coordinates.
  TriangleMesh in_metres(const TriangleMesh& unit) const;
  /// All as they are on the grid of the unit frame.
  TriangleMesh on_grid_in_metres(const TriangleMesh& unit) const;

 private:
  UnitFrame frame_;
  TriangleMesh mesh_;
  std::size_t merged_vertex_count_ = 0, dropped_triangle_count_ = 0;
  std::map<Point, Point> metres_of_;  ///< of the first input vertex at every unit position
};

}  // namespace souple
