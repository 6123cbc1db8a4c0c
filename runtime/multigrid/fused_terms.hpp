// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <vector>

#include "runtime/multigrid/row_products.hpp"

namespace souple {

/// T + T^T, T = P^T (U + D/2) P (see GalerkinPlan), by coarse block: every block of T is a list of
/// weighted fine blocks, summed in registers. Eight bytes a term: for rows of P with two weights.
class FusedTerms {
 public:
  /// The same products as `plan`, multiplied out.
  static FusedTerms create(const BlockPattern& fine, const RowProductsPlan& plan);

  void replay(const BlockMatrixF& fine, BlockMatrixF& coarse) const;
  std::size_t bytes() const;
  double flops() const;

 private:
  struct Target {
    Index upper, lower;          ///< positions of coarse block (a, b), a <= b, and of (b, a)
    Index upper_end, lower_end;  ///< of the terms of T_ab and, after them, of T_ba; none if a = b
  };
  struct Term {
    Index source;  ///< position of the fine block
    float weight;
  };

  std::vector<Target> targets_;
  std::vector<Term> terms_;
};

}  // namespace souple
