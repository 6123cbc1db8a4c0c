// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "tools/surface/mend_steps.hpp"

namespace souple {

enum class CollapseRule {
  lindstrom_turk,    ///< keeps the volume
  garland_heckbert,  ///< quadrics of the planes: other triangles, farther from folding over
};

/// Collapses edges of a closed manifold surface at unit size until at most `faces` are left, or none
/// can go. Counts triangles less.
MendStep collapse_edges(const TriangleMesh& mesh, std::size_t faces, CollapseRule rule);

}  // namespace souple
