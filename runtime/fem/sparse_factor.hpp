// SPDX-License-Identifier: MIT
#pragma once
#include <span>

#include "runtime/fem/block_matrix.hpp"
#include "runtime/fem/inverse_block.hpp"

namespace souple {

/// Sparse Cholesky factor, in double, of the part of a block matrix on chosen nodes: multifrontal, in
/// the order of a nested dissection. The pattern is analysed once; factorize and solve allocate
/// nothing.
class SparseFactor {
 public:
  /// Keeps the rows and columns of `nodes`, in this order. `positions`: of all nodes of the matrix.
  void analyze(const BlockPattern& pattern, std::span<const Point> positions,
               std::span<const Index> nodes);
  /// False if the part is not positive definite to working precision.
  bool factorize(const BlockMatrix& a);
  /// Scalars: three per chosen node.
  Eigen::Index size() const { return 3 * Eigen::Index(place_.size()); }
  /// x = A^-1 x. `x` and `work` have size() entries and do not overlap.
  void solve(Eigen::Ref<Eigen::VectorXd> x, Eigen::Ref<Eigen::VectorXd> work) const;
  /// Rows and columns of A^-1 at some of the chosen nodes. `chosen`: positions among the nodes given to
  /// analyze, in any order. `block`: (3n)^2 numbers, row-major, symmetric to the bit. Allocates nothing
  /// once `work` was used for as many nodes.
  void inverse_block(std::span<const Index> chosen, std::span<double> block,
                     InverseBlockWork& work) const;
  /// Of what a solve reads twice.
  std::size_t factor_bytes() const { return panels_.size() * sizeof(double); }
  std::size_t bytes() const;

 private:
  void load_front(const FrontPlan::Front& front, const BlockMatrix& a);
  void add_update(const FrontPlan::Front& child, const FrontPlan::Front& front);
  const double* panel(const FrontPlan::Front& front) const {
    return panels_.data() + front.panel_begin;
  }
  void forward(const FrontPlan::Front& front, Eigen::Ref<Eigen::VectorXd> y) const;
  void backward(const FrontPlan::Front& front, Eigen::Ref<Eigen::VectorXd> y) const;

  FrontPlan plan_;
  std::vector<Index> place_;    ///< in the order, by chosen node
  std::vector<double> panels_;  ///< own columns of every front, by columns
  std::vector<double> stack_;   ///< open updates
  std::vector<double> update_;  ///< of the front in work
  std::vector<double> strips_;  ///< of its border, in the order of the products
  std::size_t open_ = 0;        ///< scalars on the stack
};

}  // namespace souple
