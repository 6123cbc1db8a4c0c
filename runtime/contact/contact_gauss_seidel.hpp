// SPDX-License-Identifier: MIT
// NLCP Gauss-Seidel (METHOD 4, Alg. 13 corrected; Duriez et al. 2006) over any operator W, in update
// form: the gap u = W f + q is kept current, and W is touched only where a force changed.
#pragma once
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/contact/local_law.hpp"
#include "runtime/world/settings.hpp"

namespace souple {

/// W and q of a problem, and the gap u = W f + q that belongs to the forces so far. Three rows per
/// contact: normal, two tangential. W need not be symmetric or regular; u in m, f in N.
template <class Operator>
concept ContactOperator = requires(Operator op, const Operator read, std::size_t i,
                                   const Vec3& force_change, std::span<const double> force) {
  { read.size() } -> std::convertible_to<std::size_t>;      // contacts
  { read.diagonal_block(i) } -> std::convertible_to<Mat3>;  // W_ii; asked once per solve
  op.start(force);                                          // u = W f + q
  { read.gap(i) } -> std::convertible_to<Vec3>;             // u_i
  op.add_influence(i, force_change);                        // u += W(:, i) force_change
};

/// An operator whose gap drifts by rounding (single precision) also has refresh(f), which makes
/// u = W f + q anew in full precision. Convergence is then only granted while the residual is within
/// four digits of that of a fresh gap.
template <class Operator>
concept RefreshableOperator = ContactOperator<Operator> &&
    requires(Operator op, std::span<const double> force) {
  op.refresh(force);
};

struct ContactSolveReport {
  int sweeps = 0;
  /// Natural map of all constraints over the norm of their forces, as the last full sweep met it: each
  /// constraint with the gap at its turn. An independent judge is natural_map_residual.
  double residual = 0;
  bool converged = false;  ///< residual and the relative change of the forces are within tolerance
};

/// Memory of a solver; nothing is allocated once it has grown.
struct GaussSeidelWork {
  std::vector<LocalLaw> laws;
  std::vector<std::uint32_t> active;  ///< bore a force after the last full sweep
};

namespace gauss_seidel {

/// Of one sweep.
struct Sums {
  double largest_change = 0, largest_force = 0;  ///< N
  double residual2 = 0, force2 = 0;              ///< N^2, of a judged sweep
  double deepest = 0;                            ///< m, of a judged sweep

  bool quiet(double tolerance) const { return largest_change <= tolerance * largest_force; }
  double residual() const { return force2 > 0 ? std::sqrt(residual2 / force2) : std::sqrt(residual2); }
};

/// One turn of constraint i. `judged`: its natural map, as found, enters the sums.
template <bool judged, ContactOperator Operator>
void visit(Operator& op, const LocalLaw& law, std::size_t i, double* force, Sums& sums) {
  if (!law.movable()) return;
  const Vec3 gap = op.gap(i);
  Eigen::Map<Vec3> f(force);
  // An open contact that stays open.
  if (!law.bilateral() && f[0] == 0 && gap[0] >= 0) return;
  if constexpr (judged) {
    sums.residual2 += law.natural_map(gap, f).squaredNorm();
    if (!law.bilateral()) sums.deepest = std::max(sums.deepest, -gap[0]);
  }
  const Vec3 next = law.next_force(gap, f), change = next - f;
  const double size2 = change.squaredNorm(), force2 = next.squaredNorm();
  if (size2 > 0) op.add_influence(i, change);
  f = next;
  // Squares; the sweep takes the roots.
  sums.largest_change = std::max(sums.largest_change, size2);
  sums.largest_force = std::max(sums.largest_force, force2);
  if constexpr (judged) sums.force2 += force2;
}

inline void take_roots(Sums& sums) {
  sums.largest_change = std::sqrt(sums.largest_change);
  sums.largest_force = std::sqrt(sums.largest_force);
}

/// A judged turn of every constraint; finds the active ones.
template <ContactOperator Operator>
Sums sweep_all(Operator& op, GaussSeidelWork& work, std::span<double> force) {
  Sums sums;
  work.active.clear();
  for (std::size_t i = 0; i < op.size(); ++i) {
    visit<true>(op, work.laws[i], i, &force[3 * i], sums);
    if (force[3 * i] != 0 || work.laws[i].bilateral()) work.active.push_back(std::uint32_t(i));
  }
  take_roots(sums);
  return sums;
}

template <ContactOperator Operator>
Sums sweep_active(Operator& op, GaussSeidelWork& work, std::span<double> force) {
  Sums sums;
  for (const std::uint32_t i : work.active)
    visit<false>(op, work.laws[i], i, &force[3 * std::size_t(i)], sums);
  take_roots(sums);
  return sums;
}

/// The laws' constants and the first gap. What cannot move bears no force.
template <ContactOperator Operator>
void start(Operator& op, std::span<const ConstraintLaw> laws, std::span<double> force,
           GaussSeidelWork& work) {
  work.laws.clear();
  work.active.reserve(op.size());
  for (std::size_t i = 0; i < op.size(); ++i) {
    work.laws.emplace_back(laws[i], op.diagonal_block(i));
    if (!work.laws[i].movable()) std::fill_n(&force[3 * i], 3, 0.0);
  }
  op.start(force);
}

}  // namespace gauss_seidel

/// Solves for `force` (3 per constraint: in the start, out the result; any finite start will do) until
/// both the relative change of the forces in a sweep and the natural map are within the tolerance, and
/// no contact is deeper than asked, or the sweeps are used up. Between full sweeps only constraints
/// that bear a force are visited. The operator is left with the gap of the result. Converged forces
/// depend on the order of the contacts only within the tolerance, and not at all where W determines
/// them.
template <ContactOperator Operator>
ContactSolveReport solve_by_gauss_seidel(Operator& op, std::span<const ConstraintLaw> laws,
                                         const ContactSolverSettings& settings, std::span<double> force,
                                         GaussSeidelWork& work) {
  constexpr int full_sweep_period = 8;
  // Of the residual that a fresh gap began with: where single precision still has its digits, and
  // where its digits would end soon.
  constexpr double digits_of_single = 1e-4, worth_a_refresh = 1e-3;
  ContactSolveReport report;
  gauss_seidel::start(op, laws, force, work);
  double residual_when_fresh = -1;  // of the first full sweep on a fresh gap
  bool verify = true;
  while (report.sweeps < settings.max_sweeps) {
    if (!verify && report.sweeps % full_sweep_period != 0) {
      verify = gauss_seidel::sweep_active(op, work, force).quiet(settings.tolerance);
      ++report.sweeps;
      continue;
    }
    const gauss_seidel::Sums sums = gauss_seidel::sweep_all(op, work, force);
    ++report.sweeps;
    report.residual = sums.residual();
    verify = false;
    const bool solved = sums.quiet(settings.tolerance) && report.residual <= settings.tolerance &&
                        (settings.penetration_m == 0 || sums.deepest <= settings.penetration_m);
    if constexpr (RefreshableOperator<Operator>) {
      const bool fresh = residual_when_fresh < 0;
      if (fresh) residual_when_fresh = report.residual;
      const bool trusted = report.residual >= digits_of_single * residual_when_fresh;
      if (!fresh && (solved ? !trusted : report.residual <= worth_a_refresh * residual_when_fresh)) {
        op.refresh(force);
        residual_when_fresh = -1;
        verify = true;
        continue;
      }
    }
    if (solved) {
      report.converged = true;
      break;
    }
  }
  return report;
}

}  // namespace souple
