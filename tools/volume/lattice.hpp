// SPDX-License-Identifier: GPL-3.0-or-later
// Isosurface stuffing on a uniform body-centred cubic lattice (Labelle and Shewchuk, Isosurface
// stuffing: fast tetrahedral meshes with good dihedral angles, 2007).
#pragma once
#include <cstddef>
#include <functional>

#include "formats/core/mesh.hpp"
#include "tools/geometry/surface_measure.hpp"

namespace souple {

/// Negative inside, an estimate of the distance near the surface.
using Implicit = std::function<double(const Point&)>;

/// Number of lattice nodes that stuff_isosurface would evaluate.
double lattice_node_count(const Box& box, double spacing);

/// Tets of the inside of `inside`, which must lie within `box`; `spacing` is the side of the lattice's
/// cubes. Whatever the function, dihedral angles lie between 10.7 and 164.8 degrees. The boundary may
/// touch itself at nodes and edges. Nodes and tets in the order of the lattice; empty if no lattice
/// node is inside.
TetMesh stuff_isosurface(const Implicit& inside, const Box& box, double spacing);

}  // namespace souple
