// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>

#include "formats/core/mesh.hpp"

namespace souple {

/// Wall seconds of one step by phase.
struct PhaseTimes {
  double free_motion_s = 0;  ///< rotations, assembly, PCG
  double collision_s = 0;
  double compliance_s = 0;  ///< Delassus operator
  double contact_solve_s = 0;
  double correction_s = 0;
  double total_s = 0;
};

/// What one step did and how well the laws are met, measured outside the solvers after the step.
struct StepReport {
  PhaseTimes times;
  std::size_t contact_count = 0;  ///< pairs that entered the contact problem
  std::size_t active_count = 0;   ///< of these, carrying force
  /// Pairs left out because a body's compliance is limited to a region that they are outside of.
  std::size_t uncovered_count = 0;
  std::size_t island_count = 0;      ///< problems that were solved apart from each other
  std::size_t sleeping_count = 0;    ///< bodies that were not stepped
  int contact_sweeps = 0;            ///< of the island that took most, summed over the passes
  double contact_residual = 0;       ///< natural map, rho_i = 1 / mean eigenvalue of W_ii, over ||f||
  int free_motion_iterations = 0;    ///< summed over bodies
  double free_motion_residual = 0;   ///< worst relative residual over bodies
  int unconverged_count = 0;         ///< solves that missed their tolerance
  double worst_penetration_m = 0;    ///< at boundary vertices
  double worst_surface_depth_m = 0;  ///< true depth of the deformed surface
  double worst_joint_error_m = 0;    ///< between points that joints and grabs hold together
  double cone_violation = 0;         ///< max (|f_t| - mu f_n) / max |f|
  double kinetic_energy_j = 0;
  double elastic_energy_j = 0;
  double potential_energy_j = 0;  ///< of gravity, from the origin
  double load_work_j = 0;         ///< of loads other than gravity, in this step
  /// What the three energies fell short of those before and the work of the loads: damping, friction,
  /// impacts and the error of the integrator, less what driven nodes and driven bodies put in. 0 in the
  /// first step that is measured.
  double lost_energy_j = 0;
  Point linear_momentum_kg_m_s{};    ///< of all bodies that forces move
  Point angular_momentum_kg_m2_s{};  ///< about the origin
};

}  // namespace souple
