// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a lattice tet that lies inside, as tets that fit those of its neighbours.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <unordered_map>

#include "formats/core/mesh.hpp"

namespace souple {

struct StencilNode {
  std::uint64_t id = 0;  ///< of a lattice node or of the cut of an edge
  int sign = 0;          ///< 1 inside, 0 on the surface, -1 outside
  /// Quadrilaterals are split through their node of lowest (rank, id), the same seen from both sides:
  /// 0 cuts of long edges, 1 and 2 lattice nodes of even and odd parity, 3 cuts of short edges.
  int rank = 0;
  Point point{};
};

class StencilWriter {
 public:
  /// The node on the edge between two corners of the tet, one inside and one outside.
  using CutOf = std::function<StencilNode(std::size_t, std::size_t)>;

  void write(const std::array<StencilNode, 4>& tet, const CutOf& cut_of);
  TetMesh take() { return std::move(mesh_); }

 private:
  void write_tet(const std::array<StencilNode, 4>& nodes);
  void write_pyramid(const StencilNode& apex, const std::array<StencilNode, 4>& quad);
  void write_prism(const std::array<StencilNode, 6>& prism);
  Index number(const StencilNode& node);

  TetMesh mesh_;
  std::unordered_map<std::uint64_t, Index> numbers_;
};

}  // namespace souple
