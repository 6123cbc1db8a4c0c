// SPDX-License-Identifier: GPL-3.0-or-later
// From any imported surface to one that encloses a volume.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"
#include "tools/geometry/surface_samples.hpp"
#include "tools/surface/prepare.hpp"
#include "tools/surface/triage.hpp"

namespace souple {

enum class RepairMode {
  automatic,  ///< mend, and wrap what mending cannot close
  mend,       ///< no wrap: refuse instead
  wrap,       ///< always wrap
  off,        ///< orientation only: refuse what is not closed and manifold
};

struct RepairOptions {
  RepairMode mode = RepairMode::automatic;
  double max_error_m = 0;  ///< how far a wrap may lie from the surface; 0: 1/100 of the box diagonal
};

struct RepairAction {
  std::string name;       ///< "stitch", "fill holes", "remove self-intersections", "union", "wrap", …
  std::size_t count = 0;  ///< of what: in `detail`
  std::string detail;
};

struct RepairReport {
  SurfaceTriage before;
  SurfaceTriage after;  ///< of the result: good, or repairable where self-intersections are left
  std::vector<RepairAction> actions;
  bool wrapped = false;
  OrientReport orient;
  /// Between what came in and what goes out; `forth` is of the input from the result.
  TwoSidedDistance moved;
};

struct RepairedSurface {
  TriangleMesh mesh;  ///< closed, manifold, outward; cavities face inward
  RepairReport report;
};

/// Merges, orients, stitches, removes degenerate and duplicate triangles, separates non-manifold parts,
/// fills holes, resolves self-intersections, unites shells that cross, keeps shells inside another as
/// cavities (CGAL Polygon_mesh_processing); what is still not a solid is wrapped (CGAL Alpha_wrap_3,
/// Portaneri et al. 2022) at an offset below max_error_m, at several alphas, so that a wrap that became
/// a double skin or lost the shape is noticed and not taken. Deterministic; no time limits inside.
/// Issues: surface_invalid, surface_no_volume, surface_hopeless, surface_wrap_failed, and with mode off
/// those of orient_closed_surface.
Result<RepairedSurface> repair_surface(const TriangleMesh& surface, const RepairOptions& options);

}  // namespace souple
