// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/core/mesh.hpp"

namespace souple {

/// Nodes along the Morton curve, tets positive and sorted: an order that depends on the geometry alone.
/// Coordinates within [-0.5, 0.5] or little beyond.
TetMesh in_canonical_order(const TetMesh& mesh);

}  // namespace souple
