// SPDX-License-Identifier: MIT
// What one constraint of a contact problem does with its own 3x3 block of W, and how far it is from
// its law. Rows: normal, two tangential.
#pragma once
#include <cstdint>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {

struct ConstraintLaw {
  enum class Kind : std::uint8_t {
    frictional,  ///< Signorini and Coulomb: 0 <= u_n, r_n, u_n r_n = 0; |r_t| <= mu r_n against slip
    bilateral,   ///< u = 0 in all three rows, r free: joints, grabs; see softness
  };
  Kind kind = Kind::frictional;
  double friction = 0;  ///< mu >= 0; of no meaning if bilateral
  /// Of a bilateral constraint: the compliance in series with it, of its own: s = softness times the
  /// mean eigenvalue of W_ii, u + s r = 0. Constraints that contradict each other (three points of a
  /// rigid body that turns in a step, a door with two hinges) would otherwise have no solution but
  /// forces without end.
  double softness = 0;
};

/// Projection onto K = {|r_t| <= mu r_n}; with mu = 0 the half line r_n >= 0.
Vec3 project_onto_cone(const Vec3& force, double friction);

/// A law with the constants of its block W_ii. A frictional contact with w_nn <= 0 and a block that is
/// not finite belong to things that nothing can move: they bear no force and count as solved.
class LocalLaw {
 public:
  LocalLaw(const ConstraintLaw& law, const Mat3& block);

  bool movable() const { return rho_ > 0; }
  bool bilateral() const { return bilateral_; }
  /// Alg. 13 of METHOD 4, corrected: the tangential gap is brought up to date with the change of the
  /// normal force before the tangential force is. Bilateral: force - (W_ii + s)^-1 (gap + s force).
  Vec3 next_force(const Vec3& gap, const Vec3& force) const;
  /// r - P(r - rho (u + mu |u_t| n)), N, with rho = 1 / (mean eigenvalue of W_ii); rho (u + s r).
  Vec3 natural_map(const Vec3& gap, const Vec3& force) const;

 private:
  bool bilateral_ = false;
  double friction_ = 0;
  double rho_ = 0;
  double softness_ = 0;                                 ///< s of a bilateral constraint, m/N
  double inverse_normal_ = 0, inverse_tangential_ = 0;  ///< N/m
  double coupling_[2]{};  ///< w_tn of both tangents: their gap per normal force
  Mat3 inverse_ = Mat3::Zero();
};

}  // namespace souple
