// SPDX-License-Identifier: MIT
// Levels of boxes that hang together by parents or by an embedding, made without the tools.
#pragma once
#include <array>

#include "tests/support/box_mesh.hpp"

namespace souple::test {

/// The box_mesh of twice as many cells, with its parents in the box_mesh of `coarse_cells`: a red
/// refinement of it.
MeshLevel nested_box(const std::array<int, 3>& coarse_cells, const Point& origin, const Point& size);

/// `mesh` as a level whose nodes are embedded in the tet of `coarse` that holds them, or that they are
/// least outside of; all tets are tried.
MeshLevel embedded_level(TetMesh mesh, const TetMesh& coarse);

}  // namespace souple::test
