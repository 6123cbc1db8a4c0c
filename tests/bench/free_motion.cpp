// SPDX-License-Identifier: GPL-3.0-or-later
// What a free-motion step costs with every solver: rotations, assembly, forces and the solve to 1e-4 of
// the right side, of a liver that is held at one side, in the midst of its fall (dynamic) or on its way
// to equilibrium (quasi-static). Thread CPU time, the least of some runs; the solvers take turns.
//
//   souple_bench_free_motion small    1k to 30k tets
//   souple_bench_free_motion large    150k tets
#include <ctime>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <map>

#include "runtime/solve/solver_parts.hpp"
#include "runtime/world/bodies.hpp"
#include "runtime/world/integrator.hpp"
#include "tests/bench/bench_data.hpp"
#include "tests/bench/free_motion_bodies.hpp"
#include "tests/bench/row.hpp"

namespace souple::bench {
namespace {

constexpr double tolerance = 1e-4;

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

/// A body at a state that is the same for all solvers.
class Bench {
 public:
  Bench(const HeldBody& held, Integrator integrator)
      : held_(held), body_(held.asset, held.name), factors_(factors_of(*held.asset, integrator)) {
    rule_.integrator = integrator;
    rule_.gravity = {0, 0, -9.81};
    const CorotationalModel& model = held.asset->model();
    for (const Index node : held.asset->find_fixed_set(held_set)->nodes)
      body_.is_fixed[std::size_t(node)] = 1;
    for (Index node = 0; node < model.node_count(); ++node) {
      if (!body_.is_fixed[std::size_t(node)]) body_.free_nodes.push_back(node);
      node_entry(body_.x, node) = as_vec3(model.rest_positions()[std::size_t(node)]);
    }
    use(SolverKind::multigrid_pcg);
    for (int step = 0; step < (integrator == Integrator::quasi_static ? 3 : 25); ++step) {
      solve(1e-6);
      body_.take_motion(rule_, false);
    }
    x_ = body_.x;
    v_ = body_.v;
  }

  SolverKind default_kind() const { return held_.asset->default_solver(); }

  void use(SolverKind kind) {
    auto& solver = solvers_[kind];
    if (!solver)
      solver.emplace(
          value_or_exit(parts_.make_solver(kind, {&held_.asset->model(), held_.levels, body_.free_nodes,
                                                  factors_.mass, factors_.stiffness})));
    body_.solver.swap(solver);
    if (kind_ != SolverKind::automatic) solvers_[kind_].swap(solver);
    kind_ = kind;
  }

  /// Seconds of one step.
  double step(SolverKind kind, SolveReport& report) {
    if (kind != kind_) use(kind);
    body_.x = x_;
    body_.v = v_;
    const double start = thread_seconds();
    report = solve(tolerance);
    return thread_seconds() - start;
  }
  double work_units() const { return body_.solver->work_units(); }

 private:
  static SystemFactors factors_of(const SoftBodyAsset& asset, Integrator integrator) {
    return system_factors(integrator, 0.01, asset.model().rayleigh_mass_per_s(),
                          asset.model().rayleigh_stiffness_s());
  }

  SolveReport solve(double to) {
    FreeMotionSettings settings;
    settings.tolerance = to;
    settings.max_iterations = 5000;
    body_.prepare_free_motion(rule_);
    body_.add_inertia(rule_);
    return body_.solve_free_motion(rule_, settings);
  }

  const HeldBody& held_;
  SoftBody body_;
  SystemFactors factors_;
  StepRule rule_;
  SolverParts parts_;
  std::map<SolverKind, std::optional<StepSolver>> solvers_;
  SolverKind kind_ = SolverKind::automatic;
  Eigen::VectorXd x_, v_;
};

struct Figures {
  double default_s = 0, jacobi_s = 0;
  double gain() const { return jacobi_s / default_s; }
};

/// All solvers on one body; a row each where `rows` is set.
Figures compare(const HeldBody& held, const std::string& size, Integrator integrator, int runs,
                const std::vector<SolverKind>& kinds) {
  Bench bench(held, integrator);
  const std::string name =
      "free_motion." + size + (integrator == Integrator::quasi_static ? "_static_" : "_dynamic_");
  std::map<SolverKind, double> least;
  std::map<SolverKind, SolveReport> reports;
  std::map<SolverKind, double> units;
  for (int run = 0; run < runs; ++run)
    for (const SolverKind kind : kinds) {
      const double seconds = bench.step(kind, reports[kind]);
      least[kind] = run == 0 ? seconds : std::min(least[kind], seconds);
      units[kind] = bench.work_units();
    }
  for (const SolverKind kind : kinds) {
    const SolveReport& report = reports[kind];
    std::printf("# %-36s %9.3f ms, %4d iterations of %5.2f work units, residual %.1e%s\n",
                (name + std::string(solver_name(kind))).c_str(), 1e3 * least[kind], report.iterations,
                units[kind], report.relative_residual, report.converged ? "" : " NOT CONVERGED");
    print_row(name + std::string(solver_name(kind)), "ms", report.converged ? 1e3 * least[kind] : 1e9,
              ResultHash{});
  }
  return {least[bench.default_kind()], least[SolverKind::jacobi_pcg]};
}

std::vector<SolverKind> kinds_but(std::initializer_list<SolverKind> left_out) {
  std::vector<SolverKind> kinds;
  for (const auto& known : solver_names)
    if (known.kind != SolverKind::automatic &&
        std::ranges::find(left_out, known.kind) == left_out.end())
      kinds.push_back(known.kind);
  return kinds;
}

void small_bodies() {
  double least_gain = 1e9;
  const auto note = [&](const Figures& figures) { least_gain = std::min(least_gain, figures.gain()); };
  for (const auto& [size, tets, levels] :
       {std::tuple("1k", 1000, 1), std::tuple("3k", 3000, 2), std::tuple("30k", 30000, 2)}) {
    const HeldBody held = held_surface("liver-smooth.obj", std::size_t(tets), levels);
    for (const Integrator integrator : {Integrator::implicit_euler, Integrator::quasi_static})
      note(compare(held, size, integrator, 5, kinds_but({SolverKind::multigrid, SolverKind::direct})));
  }
  const HeldBody held = held_surface("liver-smooth.obj", 10000, 2);
  const Figures dynamic = compare(held, "10k", Integrator::implicit_euler, 15, kinds_but({}));
  note(dynamic);
  note(compare(held, "10k", Integrator::quasi_static, 7, kinds_but({})));
  print_row("free_motion.step_10k", "ms", 1e3 * dynamic.default_s, ResultHash{});
  print_row("free_motion.least_gain", "ratio", least_gain, ResultHash{});
}

void large_body() {
  const HeldBody held = held_surface("liver-smooth.obj", 150000, 3);
  const auto kinds = kinds_but({SolverKind::multigrid, SolverKind::direct});
  const Figures dynamic = compare(held, "150k", Integrator::implicit_euler, 3, kinds);
  const Figures at_rest = compare(held, "150k", Integrator::quasi_static, 2, kinds);
  print_row("free_motion.gain_150k_dynamic", "ratio", dynamic.gain(), ResultHash{});
  print_row("free_motion.gain_150k_static", "ratio", at_rest.gain(), ResultHash{});
}

}  // namespace
}  // namespace souple::bench

int main(int count, char** arguments) {
  if (count == 2 && std::strcmp(arguments[1], "small") == 0) {
    souple::bench::small_bodies();
  } else if (count == 2 && std::strcmp(arguments[1], "large") == 0) {
    souple::bench::large_body();
  } else {
    std::fprintf(stderr, "usage: %s small|large\n", arguments[0]);
    return 1;
  }
}
