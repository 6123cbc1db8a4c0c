// SPDX-License-Identifier: MIT
#include "runtime/solve/solver_parts.hpp"

#include "runtime/multigrid/multigrid_preconditioner.hpp"
#include "runtime/solve/block_jacobi.hpp"
#include "runtime/solve/direct_solver.hpp"
#include "runtime/solve/symmetric_gauss_seidel.hpp"
#include "runtime/solve/warped_preconditioner.hpp"

namespace souple {
namespace {

using Made = Result<std::unique_ptr<Preconditioner>>;

std::vector<Index> fixed_nodes(const SolverBody& body) {
  std::vector<Index> fixed;
  std::size_t next = 0;
  for (Index node = 0; node < body.model->node_count(); ++node)
    if (next < body.free_nodes.size() && body.free_nodes[next] == node)
      ++next;
    else
      fixed.push_back(node);
  return fixed;
}

// The rest matrix with identity rows for fixed nodes, as a step has it.
BlockMatrix rest_matrix(const SolverBody& body) {
  BlockMatrix a(body.model->pattern());
  body.model->assemble_rest(body.mass_factor, body.stiffness_factor, a);
  std::vector<char> is_held(std::size_t(body.model->node_count()), 1);
  for (const Index node : body.free_nodes) is_held[std::size_t(node)] = 0;
  body.model->hold_nodes(is_held, a);
  return a;
}

}  // namespace

Result<std::shared_ptr<const RestFactor>> SolverParts::factor(const SolverBody& body) {
  if (!factor_) {
    auto made =
        RestFactor::create(*body.model, body.mass_factor, body.stiffness_factor, body.free_nodes);
    if (!made) return made.issue();
    factor_ = std::make_shared<const RestFactor>(std::move(*made));
  }
  return factor_;
}

Result<std::shared_ptr<const MultigridHierarchy>> SolverParts::hierarchy(const SolverBody& body) {
  if (!hierarchy_) {
    const CorotationalModel& model = *body.model;
    const std::vector<Index> fixed = fixed_nodes(body);
    auto made = body.levels.empty()
                    ? MultigridHierarchy::open(body.stored_levels, body.coarsest_nodes,
                                               model.rest_positions(), model.pattern(), fixed)
                    : MultigridHierarchy::create(body.levels, model.pattern(), fixed);
    if (!made) return made.issue();
    hierarchy_ = std::make_shared<const MultigridHierarchy>(std::move(*made));
  }
  return hierarchy_;
}

// The V-cycle that every instance needs of its own: of the rest matrix, made current once.
Made SolverParts::rest_cycle(const SolverBody& body) {
  auto levels = hierarchy(body);
  if (!levels) return levels.issue();
  auto cycle = std::make_unique<MultigridPreconditioner>(std::move(*levels));
  const BlockMatrix a = rest_matrix(body);
  if (!cycle->update({&a, {}}))
    return make_issue(IssueCode::solver_not_possible,
                      "the matrix of the rest shape is not positive definite; the worst tet is " +
                          std::to_string(body.model->worst_element()));
  return std::unique_ptr<Preconditioner>(std::move(cycle));
}

Made SolverParts::make_preconditioner(SolverKind kind, const SolverBody& body) {
  const Index node_count = body.model->node_count();
  if (kind == SolverKind::jacobi_pcg)
    return std::unique_ptr<Preconditioner>(std::make_unique<BlockJacobi>(node_count));
  if (kind == SolverKind::direct)
    return std::unique_ptr<Preconditioner>(
        std::make_unique<DirectSolver>(*body.model, body.free_nodes));
  if (kind == SolverKind::multigrid || kind == SolverKind::multigrid_pcg) {
    auto levels = hierarchy(body);
    if (!levels) return levels.issue();
    // Alone, a cycle of two sweeps is faster on any body.
    const int sweeps = kind == SolverKind::multigrid ? 2 : sweeps_that_pay(node_count);
    return std::unique_ptr<Preconditioner>(
        std::make_unique<MultigridPreconditioner>(std::move(*levels), sweeps));
  }
  if (kind == SolverKind::warped_pcg) {
    auto shared = factor(body);
    if (!shared) return shared.issue();
    return std::unique_ptr<Preconditioner>(std::make_unique<WarpedPreconditioner>(
        std::make_unique<RestFactorPreconditioner>(std::move(*shared)), node_count));
  }
  if (kind == SolverKind::warped_multigrid_pcg) {
    auto cycle = rest_cycle(body);
    if (!cycle) return cycle.issue();
    return std::unique_ptr<Preconditioner>(
        std::make_unique<WarpedPreconditioner>(std::move(*cycle), node_count));
  }
  return std::unique_ptr<Preconditioner>(std::make_unique<SymmetricGaussSeidel>(node_count));
}

Result<StepSolver> SolverParts::make_solver(SolverKind kind, const SolverBody& body) {
  auto preconditioner = make_preconditioner(kind, body);
  if (!preconditioner) return preconditioner.issue();
  const bool is_alone = kind == SolverKind::direct || kind == SolverKind::multigrid;
  return StepSolver(is_alone ? Iteration::descent : Iteration::conjugate_gradient,
                    std::move(*preconditioner), body.model->node_count());
}

Result<StepSolver> SolverParts::make_automatic_solver(SolverKind kind, const SolverBody& body) {
  auto solver = make_solver(kind, body);
  if (kind != SolverKind::warped_pcg) return solver;
  if (!solver) return make_solver(SolverKind::multigrid_pcg, body);
  auto spare = make_preconditioner(SolverKind::multigrid_pcg, body);
  if (!spare) return spare.issue();
  solver->add_spare(std::move(*spare));
  return solver;
}

std::size_t SolverParts::bytes() const {
  return (factor_ ? factor_->bytes() : 0) + (hierarchy_ ? hierarchy_->bytes() : 0);
}

}  // namespace souple
