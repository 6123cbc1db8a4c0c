// SPDX-License-Identifier: GPL-3.0-or-later
// All three-dimensional local problems of the data's contact folder: the worst time to 1e-4 and to
// 1e-8, with plain Gauss-Seidel beside the default. A problem that misses the tolerance counts with the
// time limit.
#include <algorithm>

#include "formats/fclib/read_fclib.hpp"
#include "runtime/contact/contact_judgement.hpp"
#include "runtime/contact/solve_contact_problem.hpp"
#include "tests/bench/bench_data.hpp"
#include "tests/bench/row.hpp"

namespace {

using namespace souple;
using namespace souple::bench;

constexpr double most_seconds = 2;
constexpr int runs = 5;

struct Problems {
  std::vector<ContactProblem> solvable;
  int refused = 0;  // two dimensions, global
};

Problems read_problems() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(data_folder() / "contact"))
    if (entry.path().extension() == ".hdf5") files.push_back(entry.path());
  std::ranges::sort(files);
  Problems problems;
  for (const auto& file : files) {
    Result<FclibProblem> read = read_fclib(file);
    if (read)
      problems.solvable.push_back(std::move(read->problem));
    else if (read.issue().code == IssueCode::unsupported_feature)
      ++problems.refused;
    else
      exit_with(read.issue());
  }
  return problems;
}

struct Outcome {
  double seconds = most_seconds;  // median of the runs
  double residual = 0;
};

Outcome solve(const ContactProblem& problem, ContactSolverKind solver, double tolerance,
              ResultHash& hash) {
  std::vector<double> force, seconds;
  ContactProblemSettings settings;
  settings.solver = solver;
  settings.tolerance = tolerance;
  for (int run = 0; run < runs; ++run) {
    force.assign(problem.q.size(), 0.0);
    const auto begin = std::chrono::steady_clock::now();
    settings.stop = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() >
             most_seconds;
    };
    seconds.push_back(seconds_of([&] { (void)solve_contact_problem(problem, settings, force); }));
  }
  hash.add(force);
  Outcome outcome{median(seconds), judge_contacts(problem, force).residual};
  if (!(outcome.residual <= tolerance)) outcome.seconds = most_seconds;
  return outcome;
}

void solve_all(const Problems& problems, ContactSolverKind solver, const std::string& suffix) {
  for (const auto& [tolerance, name] : {std::pair{1e-8, "tight"}, std::pair{1e-4, "loose"}}) {
    ResultHash hash;
    double worst_s = 0, worst_residual = 0;
    int solved = 0;
    for (const ContactProblem& problem : problems.solvable) {
      const Outcome outcome = solve(problem, solver, tolerance, hash);
      worst_s = std::max(worst_s, outcome.seconds);
      worst_residual = std::max(worst_residual, outcome.residual);
      solved += outcome.residual <= tolerance ? 1 : 0;
    }
    const std::string row = "fclib." + std::string(name);
    print_row(row + ".time" + suffix, "ms", 1e3 * worst_s, hash);
    print_row(row + ".solved" + suffix, "1", solved, hash);
    print_row(row + ".residual" + suffix, "1", worst_residual, hash);
  }
}

}  // namespace

int main() {
  const Problems problems = read_problems();
  print_row("fclib.problems", "1", double(problems.solvable.size()), {});
  print_row("fclib.refused", "1", problems.refused, {});
  solve_all(problems, ContactSolverKind::accelerated, "");
  solve_all(problems, ContactSolverKind::gauss_seidel, "_plain");
  return 0;
}
