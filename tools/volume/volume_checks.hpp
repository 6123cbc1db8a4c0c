// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// Refuses (meshing_failed) a tet that is not positive.
Status check_tets(const TetMesh& mesh);

/// The boundary must be a closed manifold.
Status check_boundary(const TetMesh& mesh);

/// The boundary must be a closed manifold, and enclose about what `surface` encloses, in as many
/// shells.
Status check_against_surface(const TetMesh& mesh, const TriangleMesh& surface);

double volume_of(const TetMesh& mesh);

}  // namespace souple
