// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/core/mesh.hpp"

namespace souple {

/// Takes away flat tets that lie on the boundary with two faces: the other two become boundary, which
/// is the flip of one boundary edge in a nearly flat place. The perturbation of the mesher cannot mend
/// them where all four nodes sit on sharp edges. `least_dihedral_deg`: what counts as flat. The
/// boundary stays manifold.
void peel_boundary_slivers(TetMesh& mesh, double least_dihedral_deg);

}  // namespace souple
