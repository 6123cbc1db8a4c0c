// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "formats/core/result.hpp"
#include "tools/surface/repair.hpp"

namespace souple {

/// What mending made of a surface at unit size.
struct Mended {
  TriangleMesh mesh;
  std::vector<RepairAction> actions;
  bool closed = false;           ///< a closed oriented manifold
  std::size_t cuts = 0;          ///< pairs of triangles that still cut each other
  double lid_share = 0;          ///< area of filled holes in the whole
  double lost_share = 0;         ///< area of open pieces left out, in that of the input
  std::optional<Issue> failure;  ///< why there is no solid, or none that is clean
};

/// Sews, orients, fills, separates, unites. `unit` is merged by position, without degenerate triangles.
Mended mend_surface(const TriangleMesh& unit);

}  // namespace souple
