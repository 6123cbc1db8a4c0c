// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/choose_solver.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "runtime/fem/corotational_model.hpp"
#include "runtime/solve/solver_parts.hpp"

namespace souple {
namespace {

constexpr double probe_step_s = 0.01, probe_tolerance = 1e-4;
constexpr Index largest_factor_nodes = 60000;  // beyond, the factor takes more memory than it may

// What a counted unit costs in time, a product with A within conjugate gradients with the diagonal
// being one: a factor and a cycle go through memory less evenly. Fitted to steps of livers of 1k and 3k
// tets; they give the order of the solvers at 30k tets and in equilibrium too
// (souple_bench_free_motion).
struct Candidate {
  SolverKind kind;
  double setup;     ///< of a new matrix, in products with it
  double per_unit;  ///< of StepSolver::work_units
};
constexpr std::array<Candidate, 4> candidates{{{SolverKind::warped_pcg, 0, 2.6},
                                               {SolverKind::multigrid_pcg, 10, 4.3},
                                               {SolverKind::jacobi_pcg, 0, 2},
                                               {SolverKind::gauss_seidel_pcg, 0, 2.8}}};

struct Probe {
  BlockMatrix a;
  std::vector<Mat3> rotations{};
  Eigen::VectorXd load{};
};

// A rotation about z by 2 atan(t) without a library's sine: the same on every machine.
Vec3 turned(const Vec3& p, double t) {
  const double s = 2 * t / (1 + t * t), c = (1 - t * t) / (1 + t * t);
  return {c * p[0] - s * p[1], s * p[0] + c * p[1], 1.1 * p[2]};
}

// Twisted by up to a radian along z and a tenth longer.
Probe make_probe(const CorotationalModel& model, double mass_factor, double stiffness_factor) {
  Eigen::AlignedBox3d box;
  for (const Point& p : model.rest_positions()) box.extend(Vec3(as_vec3(p)));
  const double height = std::max(box.sizes()[2], 1e-12 * box.sizes().maxCoeff());
  Eigen::VectorXd x(3 * Eigen::Index{model.node_count()});
  Probe probe{BlockMatrix(model.pattern())};
  probe.load.setZero(x.size());
  for (Index node = 0; node < model.node_count(); ++node) {
    const Vec3 p = as_vec3(model.rest_positions()[std::size_t(node)]) - box.center();
    node_entry(x, node) = turned(p, 0.5 * p[2] / height);
    node_entry(probe.load, node) = model.masses()[std::size_t(node)] * Vec3(0, 0, -9.81);
  }
  std::vector<Mat3> elements;
  model.element_rotations(x, elements);
  model.node_rotations(elements, probe.rotations);
  model.assemble(mass_factor, stiffness_factor, elements, probe.a);
  model.add_elastic_forces(x, elements, probe.load);
  return probe;
}

}  // namespace

Result<SolverKind> choose_solver(const Asset& asset) {
  auto model = CorotationalModel::create(asset.levels.back().mesh, asset.material);
  if (!model) return model.issue();
  const double mass = 1 / (probe_step_s * probe_step_s) + model->rayleigh_mass_per_s() / probe_step_s;
  const double stiffness = 1 + model->rayleigh_stiffness_s() / probe_step_s;
  std::vector<Index> nodes(std::size_t(model->node_count()));
  std::iota(nodes.begin(), nodes.end(), Index{0});
  SolverBody body{&*model, {}, nodes, mass, stiffness};
  body.stored_levels = asset.multigrid;
  if (!asset.multigrid.empty()) body.coarsest_nodes = asset.levels.front().mesh.nodes;
  const Probe probe = make_probe(*model, mass, stiffness);
  SolverParts parts;
  SolverKind best = SolverKind::multigrid_pcg;
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate& candidate : candidates) {
    if (candidate.kind == SolverKind::warped_pcg && model->node_count() > largest_factor_nodes)
      continue;
    auto solver = parts.make_solver(candidate.kind, body);
    if (!solver) continue;  // not possible for this body
    solver->set_system({&probe.a, probe.rotations});
    // More iterations than would make it the best one are not worth the time of a bake.
    const double per_iteration = candidate.per_unit * solver->work_units();
    const int limit = int(std::clamp((least - candidate.setup) / per_iteration, 0.0, 1000.0));
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(probe.load.size());
    const SolveReport report =
        solver->solve(probe.load, {probe_tolerance, probe.load.norm(), limit}, motion);
    const double work = candidate.setup + per_iteration * report.iterations;
    if (!report.converged || work >= least) continue;
    least = work;
    best = candidate.kind;
  }
  return best;
}

}  // namespace souple
