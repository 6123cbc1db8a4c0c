// SPDX-License-Identifier: MIT
#include "runtime/world/solver_share.hpp"

#include "runtime/world/integrator.hpp"

namespace souple {
namespace {

// An explicit step has a diagonal matrix: one iteration of the cheapest.
SolverKind chosen_solver(const SoftBody& body, const WorldSettings& settings,
                         const SystemFactors& factors) {
  if (settings.free_motion.solver != SolverKind::automatic) return settings.free_motion.solver;
  if (factors.stiffness == 0 || body.free_nodes.empty()) return SolverKind::jacobi_pcg;
  // Exact contacts need the factor anyway.
  if (settings.contact_method == ContactMethod::exact) return SolverKind::direct;
  return body.asset->default_solver();
}

}  // namespace

SolverShare::Group& SolverShare::group_of(const SoftBody& body) {
  for (const auto& group : groups_)
    if (group->asset == body.asset && group->free_nodes == body.free_nodes) return *group;
  groups_.push_back(std::make_unique<Group>(Group{body.asset, body.free_nodes, {}}));
  return *groups_.back();
}

Status SolverShare::prepare(SoftBody& body, const WorldSettings& settings) {
  const CorotationalModel& model = body.asset->model();
  const SystemFactors factors =
      system_factors(settings.integrator, settings.time_step_s, model.rayleigh_mass_per_s(),
                     model.rayleigh_stiffness_s());
  Group& group = group_of(body);
  const SolverBody described{.model = &model,
                             .free_nodes = group.free_nodes,
                             .mass_factor = factors.mass,
                             .stiffness_factor = factors.stiffness,
                             .stored_levels = body.asset->multigrid(),
                             .coarsest_nodes = body.asset->coarsest_nodes()};
  const SolverKind kind = chosen_solver(body, settings, factors);
  auto solver = settings.free_motion.solver == SolverKind::automatic
                    ? group.parts.make_automatic_solver(kind, described)
                    : group.parts.make_solver(kind, described);
  if (!solver) {
    Issue issue = solver.issue();
    if (issue.where.empty()) issue.where = body.name;
    return issue;
  }
  body.solver.emplace(std::move(*solver));
  body.solver_kind = kind;
  return {};
}

}  // namespace souple
