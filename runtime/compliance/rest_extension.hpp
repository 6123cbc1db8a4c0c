// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/fem/corotational_model.hpp"

namespace souple {

/// Displacements of the nodes that a compliance does not hold, from those that it does, in the rest
/// frame: with forces on the held nodes only, A0_ii u_i = -A0_is u_s exactly, so C0_is needs no
/// storage in the file. The factor of A0_ii is kept in half precision, computed when the asset is
/// loaded: motions are exact to 1e-3 of the largest (measured: 4e-4), which contact never sees, since
/// contacts are on held nodes. Const and shared; apply uses the caller's work and allocates nothing.
class RestExtension {
 public:
  /// `held`: nodes of the compliance, ascending. `fixed`: nodes that do not move.
  /// Issue compliance_factorisation_failed.
  static Result<RestExtension> create(const CorotationalModel& model, double mass_factor,
                                      double stiffness_factor, std::span<const Index> held,
                                      std::span<const Index> fixed);
  RestExtension(RestExtension&&) noexcept;
  RestExtension& operator=(RestExtension&&) noexcept;
  ~RestExtension();

  /// Fills the entries of the other free nodes of `u` (3 per node of the mesh, rest frame, m) from
  /// those of the held nodes. `work` has at least work_size() entries.
  void apply(Eigen::VectorXd& u, std::span<float> work) const;
  std::size_t work_size() const;
  std::size_t resident_bytes() const;

 private:
  struct State;
  explicit RestExtension(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace souple
