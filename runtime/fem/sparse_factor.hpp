// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <span>

#include "runtime/fem/block_matrix.hpp"

namespace souple {

/// Sparse Cholesky factor of the part of a block matrix on chosen nodes. The pattern is analysed once;
/// factorize may allocate, solve does not.
class SparseFactor {
 public:
  SparseFactor();
  SparseFactor(SparseFactor&&) noexcept;
  SparseFactor& operator=(SparseFactor&&) noexcept;
  ~SparseFactor();

  /// Keeps the rows and columns of `nodes`, in this order.
  void analyze(const BlockPattern* pattern, std::span<const Index> nodes);
  /// False if the part is not positive definite to working precision.
  bool factorize(const BlockMatrix& a);
  /// Scalars: three per chosen node.
  Eigen::Index size() const;
  /// x = A^-1 x. `x` and `work` have size() entries and do not overlap.
  void solve(Eigen::Ref<Eigen::VectorXd> x, Eigen::Ref<Eigen::VectorXd> work) const;
  std::size_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace souple
