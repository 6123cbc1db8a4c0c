// SPDX-License-Identifier: GPL-3.0-or-later
// Which size the mesh shall have where.
#pragma once
#include <memory>
#include <vector>

#include "tools/geometry/triangle_bvh.hpp"
#include "tools/volume/tetrahedralize.hpp"
#include "tools/volume/unit_surface.hpp"
#include "tools/volume/volume_mesher.hpp"

namespace souple {

/// Mean edge of a result over the cell radius that was asked for.
inline constexpr double edge_per_radius = 1.3;

/// Refuses regions that are empty or not finite and lengths that are not positive.
Status check_sizes(const TetrahedralizeOptions& options);

/// Cell radii in units of the surface, as a multiple of one base radius near the surface: larger by up
/// to the coarsening factor in depth, smaller in and around the local regions, and growing by at most
/// 0.3 per unit of distance in between.
class Sizing {
 public:
  /// The unit surface must outlive this and every MesherSizes made of it.
  Sizing(const UnitSurface& unit, const TetrahedralizeOptions& options);

  double cell_radius(const Point& unit_point, double base) const;
  MesherSizes sizes(double base) const;
  bool uniform() const { return coarsening_ <= 1 && local_.empty(); }

 private:
  struct Local {
    double cell_radius;
    LocalSize size;
    std::shared_ptr<const TriangleBvh> patch;
    double distance_m(const Point& x) const;
  };
  const UnitFrame& frame_;
  double coarsening_;
  double max_error_;  ///< units of the surface; 0: free
  std::shared_ptr<const TriangleBvh> surface_;
  std::vector<Local> local_;
};

}  // namespace souple
