// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <optional>

#include "runtime/multigrid/dense_solver.hpp"
#include "runtime/multigrid/gauss_seidel.hpp"
#include "runtime/multigrid/multigrid_hierarchy.hpp"
#include "runtime/solve/preconditioner.hpp"

namespace souple {

/// Sweeps for conjugate gradients on a body of `node_count` nodes. Measured: a second one takes a third
/// of the iterations away. Up to 30 000 nodes that costs a tenth more time; on large bodies about none,
/// and iterations then grow less with the mesh.
int sweeps_that_pay(Index node_count);

/// One V-cycle (METHOD 3, Alg. 5) of the finest level, symmetric: block Gauss-Seidel one way before and
/// the other way after the coarse correction, Galerkin matrices, a dense solve at the end. The coarse
/// levels are cheap and are cycled twice each (W): coarse cells are too stiff in bending where limbs
/// are thinner than they. Everything is in single precision and of unit size: A is scaled by a power of
/// two, the residual by its largest entry.
class MultigridPreconditioner final : public Preconditioner {
 public:
  /// `sweep_count` (>= 1) sweeps before and as many after.
  explicit MultigridPreconditioner(std::shared_ptr<const MultigridHierarchy> hierarchy,
                                   int sweep_count = 1);

  bool update(const StepSystem& system) override;
  void apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) override;
  double work_units() const override;
  std::size_t bytes() const override;

 private:
  struct Level {
    explicit Level(const BlockPattern& pattern);

    BlockMatrixF a;
    GaussSeidel smoother;
    PaddedVector b, x, residual, correction;
    PaddedVector first;  ///< of two cycles, the motion by the first
  };

  bool load(const BlockMatrix& a);
  void cycle(std::size_t index);
  /// Two cycles, of which the second is for what the first has left; one on the coarsest level.
  void visit(std::size_t index);
  static void smooth_before(Level& level, int sweep_count);
  static void smooth_after(Level& level, int sweep_count);
  void solve_coarsest(Level& level);

  std::shared_ptr<const MultigridHierarchy> hierarchy_;
  int sweep_count_;
  std::vector<Level> levels_;         ///< finest first
  std::optional<DenseSolver> dense_;  ///< none where the coarsest level is too large for one
  int coarse_cycle_count_ = 2;
  double scale_ = 1;  ///< of A
};

}  // namespace souple
