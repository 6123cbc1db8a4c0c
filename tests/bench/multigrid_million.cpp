// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/multigrid_million.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "formats/write/asset_writer.hpp"
#include "runtime/load/load_soft_body.hpp"
#include "runtime/multigrid/level_transitions.hpp"
#include "runtime/solve/solver_parts.hpp"
#include "runtime/world/bodies.hpp"
#include "runtime/world/integrator.hpp"
#include "tests/bench/bench_data.hpp"
#include "tests/bench/free_motion_bodies.hpp"
#include "tests/bench/row.hpp"
#include "tests/support/box_mesh.hpp"

namespace souple::bench {
namespace {

constexpr int step_count = 9;

void bake(const std::filesystem::path& file) {
  HeldBody held = held_surface("liver-smooth.obj", 1100000, 4);
  Asset asset;
  asset.levels = std::move(held.levels);
  asset.multigrid = value_or_exit(store_transitions(asset.levels));
  asset.material = test::material_of(1e4, 0.4, 1000, 0.1, 0.01);
  asset.fixed_sets.push_back(*held.asset->find_fixed_set(held_set));
  if (const Status written = write_asset(asset, file); !written) exit_with(written.issue());
}

/// So that the memory of the mesher does not count.
void bake_in_a_process_of_its_own(const std::filesystem::path& file) {
  const pid_t child = fork();
  if (child == 0) {
    bake(file);
    std::_Exit(0);
  }
  int status = 1;
  if (child < 0 || waitpid(child, &status, 0) != child || status != 0) {
    std::fprintf(stderr, "the asset of a million tets could not be baked\n");
    std::exit(1);
  }
}

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

struct Steps {
  std::size_t tets = 0;
  double load_s = 0, prepare_s = 0;
  std::vector<double> wall_s, thread_s;
  int most_iterations = 0;
  double worst_residual = 0;
  ResultHash hash;
};

/// Held at one side, at rest in its rest shape.
SoftBody held_body(std::shared_ptr<const SoftBodyAsset> asset) {
  SoftBody body(std::move(asset), "liver");
  const CorotationalModel& model = body.asset->model();
  for (const Index node : body.asset->find_fixed_set(held_set)->nodes)
    body.is_fixed[std::size_t(node)] = 1;
  for (Index node = 0; node < model.node_count(); ++node) {
    if (!body.is_fixed[std::size_t(node)]) body.free_nodes.push_back(node);
    node_entry(body.x, node) = as_vec3(model.rest_positions()[std::size_t(node)]);
  }
  return body;
}

void give_solver(SoftBody& body, SolverParts& parts, const StepRule& rule) {
  const CorotationalModel& model = body.asset->model();
  const SystemFactors factors = system_factors(
      rule.integrator, rule.time_step_s, model.rayleigh_mass_per_s(), model.rayleigh_stiffness_s());
  body.solver.emplace(value_or_exit(
      parts.make_solver(SolverKind::multigrid_pcg, {.model = &model,
                                                    .free_nodes = body.free_nodes,
                                                    .mass_factor = factors.mass,
                                                    .stiffness_factor = factors.stiffness,
                                                    .stored_levels = body.asset->multigrid(),
                                                    .coarsest_nodes = body.asset->coarsest_nodes()})));
}

/// One step without contacts; its solve.
SolveReport step(SoftBody& body, const StepRule& rule) {
  FreeMotionSettings settings;
  settings.tolerance = 1e-4;
  body.prepare_free_motion(rule);
  body.add_inertia(rule);
  const SolveReport report = body.solve_free_motion(rule, settings);
  body.take_motion(rule, false);
  return report;
}

Steps run_steps(const std::filesystem::path& file, bool stored_levels) {
  Steps steps;
  std::shared_ptr<const SoftBodyAsset> asset;
  steps.load_s =
      seconds_of([&] { asset = value_or_exit(load_soft_body(file, {.multigrid = stored_levels})); });
  steps.tets = std::size_t(asset->model().tet_count());
  StepRule rule;
  rule.gravity = {0, 0, -9.81};
  SolverParts parts;
  SoftBody body = held_body(asset);
  steps.prepare_s = seconds_of([&] { give_solver(body, parts, rule); });
  for (int k = 0; k < step_count; ++k) {
    SolveReport report;
    const double start = thread_seconds();
    steps.wall_s.push_back(seconds_of([&] { report = step(body, rule); }));
    steps.thread_s.push_back(thread_seconds() - start);
    steps.most_iterations = std::max(steps.most_iterations, report.iterations);
    steps.worst_residual = std::max(steps.worst_residual, report.relative_residual);
    std::printf("# step %d: %.3f s, thread %.3f s, %d iterations, residual %.1e\n", k,
                steps.wall_s.back(), steps.thread_s.back(), report.iterations,
                report.relative_residual);
  }
  steps.hash.add(std::span<const double>(body.x.data(), std::size_t(body.x.size())));
  return steps;
}

}  // namespace

void step_a_million(const std::filesystem::path& file) {
  bake_in_a_process_of_its_own(file);
  const Steps stored = run_steps(file, true);
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  print_row("multigrid.million_tets", "count", double(stored.tets), stored.hash);
  print_row("multigrid.million_step", "s", stored.wall_s, stored.hash);
  print_row("multigrid.million_step_cpu", "s", stored.thread_s, stored.hash);
  print_row("multigrid.million_residual", "1", stored.worst_residual, stored.hash);
  print_row("multigrid.million_iterations", "count", stored.most_iterations, stored.hash);
  print_row("multigrid.million_peak", "GiB", double(use.ru_maxrss) / double(1 << 20), stored.hash);
  print_row("multigrid.million_load", "s", stored.load_s, stored.hash);
  print_row("multigrid.million_prepare", "s", stored.prepare_s, stored.hash);
  const Steps lattice = run_steps(file, false);
  print_row("multigrid.million_step_lattice", "s", lattice.wall_s, lattice.hash);
  print_row("multigrid.million_load_lattice", "s", lattice.load_s, lattice.hash);
  print_row("multigrid.million_prepare_lattice", "s", lattice.prepare_s, lattice.hash);
}

}  // namespace souple::bench
