// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "formats/core/solver_kind.hpp"
#include "runtime/multigrid/multigrid_hierarchy.hpp"
#include "runtime/solve/rest_factor.hpp"
#include "runtime/solve/step_solver.hpp"

namespace souple {

/// Of a body whose solvers are to be made. All that is pointed at must outlive the solvers.
struct SolverBody {
  const CorotationalModel* model = nullptr;
  /// Coarsest first, the last one with the nodes of the model; empty: multigrid makes its own levels
  /// if there are no stored ones either.
  std::span<const MeshLevel> levels{};
  std::span<const Index> free_nodes{};  ///< ascending; read by make_solver alone
  double mass_factor = 0;               ///< A0 = mass_factor M + stiffness_factor K
  double stiffness_factor = 1;
  /// What an asset stores of the levels, in place of `levels`: see MultigridHierarchy::open.
  std::span<const LevelTransition> stored_levels{};
  std::span<const Point> coarsest_nodes{};
};

/// What solvers share: instances with the same model, fixed nodes and factors need it once.
class SolverParts {
 public:
  /// Ready for use, all its memory allocated. `kind` is not automatic.
  /// Issues: solver_not_possible, asset_embedding_invalid, asset_index_out_of_range,
  /// asset_multigrid_invalid.
  Result<StepSolver> make_solver(SolverKind kind, const SolverBody& body);
  /// For a body that leaves the choice: `kind`, or a V-cycle as a preconditioner where that is not
  /// possible or, as a spare, while it takes less work.
  Result<StepSolver> make_automatic_solver(SolverKind kind, const SolverBody& body);
  std::size_t bytes() const;

 private:
  Result<std::unique_ptr<Preconditioner>> make_preconditioner(SolverKind kind, const SolverBody& body);
  Result<std::unique_ptr<Preconditioner>> rest_cycle(const SolverBody& body);
  Result<std::shared_ptr<const RestFactor>> factor(const SolverBody& body);
  Result<std::shared_ptr<const MultigridHierarchy>> hierarchy(const SolverBody& body);

  std::shared_ptr<const RestFactor> factor_;
  std::shared_ptr<const MultigridHierarchy> hierarchy_;
};

}  // namespace souple
