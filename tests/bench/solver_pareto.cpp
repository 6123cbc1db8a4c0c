// SPDX-License-Identifier: GPL-3.0-or-later
// Step time against the error of the trajectory for every solver and several tolerances: a liver, a
// dinosaur and a torus, held at one side, fall for half a second. The reference has a tenth of the step
// and solves directly; the error at equal steps with a direct solve is that of the step itself, which
// no solver can beat. Writes solver_pareto_NAME.svg with the error against the reference,
// solver_pareto_NAME_solver.svg with the part of it that the solver has, and .csv; what no other solver
// dominates is marked.
//
//   souple_bench_solver_pareto FOLDER
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "runtime/world/world.hpp"
#include "tests/bench/bench_data.hpp"
#include "tests/bench/free_motion_bodies.hpp"
#include "tests/bench/line_plot.hpp"
#include "tests/bench/row.hpp"

namespace souple::bench {
namespace {

constexpr double step_s = 0.01;
constexpr int step_count = 50;

struct Run {
  SolverKind kind = SolverKind::direct;
  double tolerance = 0;
  double step_ms = 0;       ///< median of the steps
  double error = 0;         ///< root mean square over nodes and steps, over the size of the motion
  double solver_error = 0;  ///< the same against the direct solve with equal steps
};

struct Trajectory {
  std::vector<Eigen::VectorXd> shapes;  ///< after every step_s
  std::vector<double> step_ms;
};

Trajectory run(const HeldBody& held, SolverKind kind, double tolerance, int substeps) {
  WorldSettings settings;
  settings.time_step_s = step_s / substeps;
  settings.contact_method = ContactMethod::exact;
  settings.measure_laws = false;
  settings.free_motion.solver = kind;
  settings.free_motion.tolerance = tolerance;
  settings.free_motion.max_iterations = 20000;
  World world = value_or_exit(World::create(settings));
  SoftBodyDescription description;
  description.name = held.name;
  description.fixed_set = held_set;
  const BodyId body = value_or_exit(world.add_soft_body(held.asset, description));
  Trajectory trajectory;
  for (int step = 1; step <= step_count * substeps; ++step) {
    const StepReport report = value_or_exit(world.step());
    trajectory.step_ms.push_back(1e3 * report.times.free_motion_s);
    if (step % substeps != 0) continue;
    const auto x = world.positions(body);
    trajectory.shapes.emplace_back(
        Eigen::Map<const Eigen::VectorXd>(x[0].data(), Eigen::Index(3 * x.size())));
  }
  return trajectory;
}

double difference(const Trajectory& a, const Trajectory& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.shapes.size(); ++k) sum += (a.shapes[k] - b.shapes[k]).squaredNorm();
  return std::sqrt(sum);
}

double extent(const Trajectory& t) {
  double sum = 0;
  for (const auto& shape : t.shapes) sum += (shape - t.shapes.front()).squaredNorm();
  return std::sqrt(sum);
}

/// One of the two errors of a run, and what is drawn of it.
struct Axis {
  double Run::*error;
  const char* label;
  const char* suffix;  ///< of the file
};

const Axis of_trajectory{&Run::error, "error against a tenth of the step, over the motion", ""};
const Axis of_solver{&Run::solver_error, "error against the direct solve, over the motion", "_solver"};

bool is_on_front(const Run& one, const std::vector<Run>& runs, const Axis& axis) {
  return std::ranges::none_of(runs, [&](const Run& other) {
    const double error = one.*axis.error, others = other.*axis.error;
    return other.step_ms <= one.step_ms && others <= error &&
           (other.step_ms < one.step_ms || others < error);
  });
}

void draw(const std::string& name, const std::vector<Run>& runs, double step_error, const Axis& axis,
          const std::filesystem::path& folder) {
  Plot plot{name + ": step time against error; error of the step itself " + std::to_string(step_error),
            "ms a step (median)",
            axis.label,
            true,
            {}};
  PlotSeries front{"Pareto front", {}, true, false};
  for (const Run& one : runs) {
    const std::string solver(solver_name(one.kind));
    if (plot.series.empty() || plot.series.back().name != solver)
      plot.series.push_back({solver, {}, true, true});
    plot.series.back().points.emplace_back(one.step_ms, one.*axis.error);
    if (is_on_front(one, runs, axis)) front.points.emplace_back(one.step_ms, one.*axis.error);
  }
  std::ranges::sort(front.points);
  plot.series.push_back(front);
  write_plot(plot, folder / ("solver_pareto_" + name + axis.suffix + ".svg"));
}

void write(const std::string& name, const std::vector<Run>& runs, double step_error,
           const std::filesystem::path& folder) {
  std::ofstream csv(folder / ("solver_pareto_" + name + ".csv"));
  csv << "solver,tolerance,step_ms,error,solver_error,on_front,on_solver_front\n";
  for (const Run& one : runs)
    csv << solver_name(one.kind) << ',' << one.tolerance << ',' << one.step_ms << ',' << one.error
        << ',' << one.solver_error << ',' << is_on_front(one, runs, of_trajectory) << ','
        << is_on_front(one, runs, of_solver) << '\n';
  draw(name, runs, step_error, of_trajectory, folder);
  draw(name, runs, step_error, of_solver, folder);
}

void compare(const HeldBody& held, const std::filesystem::path& folder) {
  const Trajectory reference = run(held, SolverKind::direct, 1e-10, 10);
  const Trajectory direct = run(held, SolverKind::direct, 1e-10, 1);
  const double size = extent(reference);
  std::vector<Run> runs;
  for (const auto& known : solver_names) {
    if (known.kind == SolverKind::direct) continue;
    for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-6, 1e-8}) {
      const Trajectory t = run(held, known.kind, tolerance, 1);
      runs.push_back({known.kind, tolerance, median(t.step_ms), difference(t, reference) / size,
                      difference(t, direct) / size});
    }
  }
  const double step_error = difference(direct, reference) / size;
  runs.push_back({SolverKind::direct, 0, median(direct.step_ms), step_error, 0});
  write(held.name, runs, step_error, folder);
  std::printf("# %s: %d tets, error of the step itself %.2e, direct %.2f ms\n", held.name.c_str(),
              held.asset->model().tet_count(), step_error, median(direct.step_ms));
  double of_default = 0, of_jacobi = 0;
  int front = 0;
  for (const Run& one : runs) {
    std::printf("# %-22s %.0e %8.3f ms  error %.2e, of the solver %.2e %s\n",
                std::string(solver_name(one.kind)).c_str(), one.tolerance, one.step_ms, one.error,
                one.solver_error, is_on_front(one, runs, of_solver) ? "*" : "");
    front += is_on_front(one, runs, of_solver);
    if (one.tolerance == 1e-4 && one.kind == SolverKind::automatic) of_default = one.step_ms;
    if (one.tolerance == 1e-4 && one.kind == SolverKind::jacobi_pcg) of_jacobi = one.step_ms;
  }
  ResultHash hash;
  print_row("pareto." + held.name + "_front", "count", front, hash);
  print_row("pareto." + held.name + "_default_gain", "ratio", of_jacobi / of_default, hash);
}

}  // namespace
}  // namespace souple::bench

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", arguments[0]);
    return 1;
  }
  std::filesystem::create_directories(arguments[1]);
  using namespace souple::bench;
  compare(held_surface("liver-smooth.obj", 10000, 2), arguments[1]);
  compare(held_surface("dino.off", 8000, 2), arguments[1]);
  compare(held_torus(2), arguments[1]);
}
