// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

#include "formats/core/result.hpp"
#include "tools/volume/sizing.hpp"
#include "tools/volume/volume_mesher.hpp"

namespace souple {

inline constexpr std::size_t fewest_tets = 20, most_tets = 5'000'000;

/// What the base radius of the sizes is to be chosen for.
struct SizeGoal {
  enum class Kind { tet_count, mean_edge, radius };
  Kind kind = Kind::tet_count;
  double target = 0;  ///< tets, or units of the surface; for `radius` the base radius itself
  double volume = 0;  ///< of the unit surface
  double area = 0;

  /// By a model measured on livers, animals and CAD parts of 1k to 50k tets.
  double expected_tets(double radius) const;
  double expected_radius() const;
  double expected_node_count() const;
  /// Relative distance of a result from the goal; 0 if only a radius was asked for.
  double miss(double tet_count, double mean_edge) const;
  std::size_t most_vertices() const;
};

/// From the options; refuses what is out of range (usage_bad_value).
Result<SizeGoal> goal_of(const UnitSurface& unit, const TetrahedralizeOptions& options);

struct SizeAttempt {
  double radius;
  double measure;  ///< tets or mean edge
};

/// Refines until the goal is near and returns all attempts; the last one is the nearest, and the state
/// of the mesher.
Result<std::vector<SizeAttempt>> refine_to_goal(VolumeMesher& mesher, const Sizing& sizing,
                                                const SizeGoal& goal);

}  // namespace souple
