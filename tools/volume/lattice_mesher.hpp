// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/volume/volume_draft.hpp"

namespace souple {

/// An embedding cage of about the size asked for, with a manifold boundary and as many parts as the
/// surface has solids: the lattice cut at the surface; where it misses thin parts or breaks them, cut
/// at a distance outside the surface, or finer. Fails only where nothing is left at any size
/// (lattice_failed). Sizes are uniform and sharp edges are cut off; the notes say so, and how much
/// volume the cage has.
Result<VolumeDraft> mesh_by_lattice(const UnitSurface& unit, const Sizing& sizing,
                                    const SizeGoal& goal);

}  // namespace souple
