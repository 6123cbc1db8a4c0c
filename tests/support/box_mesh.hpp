// SPDX-License-Identifier: MIT
#pragma once
#include <array>

#include "formats/core/asset.hpp"

namespace souple::test {

/// An axis-aligned box of cells split into 6 tets each (Kuhn), lower corner at `origin`, sides `size`
/// m.
TetMesh box_mesh(const std::array<int, 3>& cells, const Point& origin, const Point& size);

/// The same with interior nodes moved at random (fixed seed) by up to `amount` of a cell.
TetMesh irregular_box_mesh(const std::array<int, 3>& cells, const Point& origin, const Point& size,
                           double amount);

/// A mesh as level 0 of a hierarchy.
MeshLevel level_of(TetMesh mesh);

/// One region, no damping unless given.
Material material_of(double young_pa, double poisson, double density, double alpha = 0,
                     double beta = 0);

}  // namespace souple::test
