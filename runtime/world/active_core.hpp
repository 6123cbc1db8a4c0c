// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/contact/accelerated_gauss_seidel.hpp"
#include "runtime/contact/dense_contact_operator.hpp"
#include "runtime/world/contact_operator.hpp"

namespace souple {

/// The contacts of an island that bear a force or want to, as a problem of their own with a dense W.
/// Most contacts within the alarm distance are open: whoever sweeps over the few others need not carry
/// the rows of all. Memory is kept between solves.
class ActiveCore {
 public:
  /// Takes them from the island, whose gaps belong to `force` (3 per contact). False: there is no use
  /// in it, since the sweeps would be no cheaper.
  bool take(const IslandOperator& island, std::span<const ConstraintLaw> laws,
            std::span<const double> force);
  /// The problem of take, and its forces, where its solver starts and ends.
  DenseContactOperator& rows() { return rows_; }
  std::span<const ConstraintLaw> laws() const { return laws_; }
  std::span<double> force() { return force_; }
  AcceleratedWork& solver() { return solver_; }
  /// Writes them to where they were taken from.
  void give_back(std::span<double> force) const;

 private:
  void choose(const IslandOperator& island, std::span<const ConstraintLaw> laws,
              std::span<const double> force);

  std::vector<std::uint32_t> members_, contacts_;  ///< in the island, and in the step
  std::vector<ConstraintLaw> laws_;
  std::vector<double> force_, gap_;
  DenseContactOperator rows_;
  StepContactOperator::GatherWork gather_;
  AcceleratedWork solver_;
};

}  // namespace souple
