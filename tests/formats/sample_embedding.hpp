// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "formats/core/asset.hpp"

namespace souple::test {

/// Every point in the tet that holds it, or that it lies least outside of. Tries all tets.
std::vector<Embedding> embed_points(const std::vector<Point>& points, const TetMesh& mesh);

}  // namespace souple::test
