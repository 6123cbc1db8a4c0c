// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <span>

#include "formats/core/result.hpp"
#include "runtime/fem/corotational_model.hpp"
#include "runtime/fem/half_factor.hpp"
#include "runtime/solve/preconditioner.hpp"

namespace souple {

/// Factor of the rest matrix A0 = mass_factor M + stiffness_factor K on the nodes that move, in half
/// precision; const and shared by all instances of a body. Before it is factorised, A0 is scaled to
/// diagonal blocks of order 1, so that contrasts of stiffness do not leave the range of halves.
class RestFactor {
 public:
  /// `free_nodes` ascend. Issue solver_not_possible.
  static Result<RestFactor> create(const CorotationalModel& model, double mass_factor,
                                   double stiffness_factor, std::span<const Index> free_nodes);

  const HalfFactor& factor() const { return factor_; }
  /// D^-1/2 by place in the order of the factor, so that A0^-1 = D^-1/2 factor^-1 D^-1/2.
  std::span<const float> scale() const { return scale_; }
  /// Of the blocks that a product with A reads, in double: what work is measured by.
  std::size_t matrix_bytes() const { return matrix_bytes_; }
  std::size_t bytes() const { return factor_.bytes() + scale_.size() * sizeof(float); }

 private:
  HalfFactor factor_;
  std::vector<float> scale_;
  std::size_t matrix_bytes_ = 0;
};

/// z = A0^-1 r by a RestFactor, the identity on fixed nodes. Knows nothing of the present shape.
class RestFactorPreconditioner final : public Preconditioner {
 public:
  explicit RestFactorPreconditioner(std::shared_ptr<const RestFactor> factor);

  bool update(const StepSystem&) override { return true; }
  void apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) override;
  double work_units() const override;
  /// Without what is shared.
  std::size_t bytes() const override { return (x_.size() + work_.size()) * sizeof(float); }

 private:
  std::shared_ptr<const RestFactor> factor_;
  std::vector<float> x_, work_;
};

}  // namespace souple
