// SPDX-License-Identifier: GPL-3.0-or-later
// souple solve-contact PROBLEM: solves a problem of frictional contact in FCLIB's local layout.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "formats/fclib/write_fclib.hpp"
#include "runtime/contact/contact_judgement.hpp"
#include "runtime/contact/solve_contact_problem.hpp"
#include "tools/cli/command_line.hpp"
#include "tools/cli/json_output.hpp"
#include "tools/cli/signals.hpp"
#include "tools/commands/solve_contact_input.hpp"
#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/numbers.hpp"

namespace souple {
namespace {

using Clock = std::chrono::steady_clock;

struct SolveContactOptions {
  std::string file, output, solver = "auto";
  std::string tolerance = "1e-8", seconds = "10", iterations = "1000000000", facets = "16";

  void add_to(CLI::App& app) {
    app.add_option("PROBLEM", file, "HDF5 file in FCLIB's local layout, three dimensions")->required();
    app.add_option("-o,--output", output, "HDF5 file to write: the problem with its solution");
    app.add_option("--tolerance", tolerance,
                   "largest residual: natural map with rho = 1 over the norm of q (1e-8)");
    app.add_option("--max-seconds", seconds, "seconds that solving may take (10)");
    app.add_option("--max-iterations", iterations, "sweeps that solving may take (1e9)");
    app.add_option("--solver", solver,
                   "auto, accelerated, gauss-seidel or faceted (auto, which is accelerated)");
    app.add_option("--facets", facets, "of the faceted cone (16)");
  }
};

struct Solved {
  std::vector<double> u, r;
  ContactProblemReport report;
  ContactJudgement judgement;
  double seconds = 0;
  std::size_t start = 0;  ///< 0: from zero, else from this guess
};

Result<double> number_option(const std::string& option, const std::string& text,
                             const NumberRange& range) {
  const auto value = parse_number(text);
  if (value && range.contains(*value)) return *value;
  return make_issue(IssueCode::usage_bad_value, "\"" + text + "\" cannot be used", option,
                    "Give a number in " + range.text() + ".");
}

Result<ContactSolverKind> solver_option(const std::string& name) {
  if (name == "auto" || name == "accelerated") return ContactSolverKind::accelerated;
  if (name == "gauss-seidel") return ContactSolverKind::gauss_seidel;
  if (name == "faceted") return ContactSolverKind::faceted;
  return make_issue(IssueCode::usage_bad_value, "no solver is called \"" + name + "\"", "--solver",
                    "Give auto, accelerated, gauss-seidel or faceted.");
}

std::string solver_text(ContactSolverKind kind) {
  return kind == ContactSolverKind::accelerated    ? "accelerated"
         : kind == ContactSolverKind::gauss_seidel ? "gauss-seidel"
                                                   : "faceted";
}

struct Limits {
  ContactProblemSettings settings;
  double seconds = 0;
};

Result<Limits> limits_of(const SolveContactOptions& options) {
  Limits limits;
  const auto tolerance = number_option("--tolerance", options.tolerance, {1e-16, 1, false, false});
  if (!tolerance) return tolerance.issue();
  const auto seconds = number_option("--max-seconds", options.seconds, {0, 86400, true, false});
  if (!seconds) return seconds.issue();
  const auto iterations = integer_option("--max-iterations", options.iterations, 1, 1'000'000'000);
  if (!iterations) return iterations.issue();
  const auto facets = integer_option("--facets", options.facets, 3, 4096);
  if (!facets) return facets.issue();
  const auto solver = solver_option(options.solver);
  if (!solver) return solver.issue();
  limits.settings = {*solver, *tolerance, *iterations, static_cast<int>(*facets), {}};
  limits.seconds = *seconds;
  return limits;
}

// The guess of the least residual, or zero.
std::size_t choose_start(const FclibProblem& file, std::vector<double>& force) {
  double least = judge_contacts(file.problem, force).residual;
  std::size_t start = 0;
  for (std::size_t k = 0; k < file.guesses.size(); ++k) {
    const double residual = judge_contacts(file.problem, file.guesses[k].r).residual;
    if (!(residual < least)) continue;
    least = residual;
    start = k + 1;
  }
  if (start > 0) force = file.guesses[start - 1].r;
  return start;
}

Solved solve(const FclibProblem& file, Limits limits, const InterruptFlag& interrupt) {
  Solved solved;
  solved.r.assign(file.problem.q.size(), 0.0);
  const auto begin = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  limits.settings.stop = [&] { return interrupt.raised() || seconds() >= limits.seconds; };
  solved.start = choose_start(file, solved.r);
  solved.report = solve_contact_problem(file.problem, limits.settings, solved.r);
  solved.seconds = seconds();
  solved.judgement = judge_contacts(file.problem, solved.r);
  solved.u = gap_of(file.problem, solved.r);
  // The judge has the last word on the exact laws.
  if (limits.settings.solver != ContactSolverKind::faceted)
    solved.report.converged = solved.judgement.residual <= limits.settings.tolerance;
  return solved;
}

std::optional<Issue> shortfall(const Solved& solved, const ContactProblemSettings& settings,
                               const std::string& file) {
  if (solved.report.converged) return std::nullopt;
  return make_issue(IssueCode::contact_tolerance_missed,
                    "residual " + rounded_text(solved.judgement.residual, 3) + " after " +
                        std::to_string(solved.report.sweeps) + " iterations and " +
                        rounded_text(solved.seconds, 3) + " s, asked for " +
                        exact_text(settings.tolerance),
                    file);
}

Json document_of(const SolveContactOptions& options, const FclibProblem& file, const Solved& solved,
                 const ContactProblemSettings& settings, const std::optional<Issue>& issue) {
  const ContactJudgement& j = solved.judgement;
  Json document = schema_header("solve-contact");
  document.update(
      {{"input", options.file},
       {"title", file.problem.title},
       {"contacts", file.problem.contact_count()},
       {"blocks", file.problem.w.row.size()},
       {"solver", solver_text(settings.solver)},
       {"facets", settings.solver == ContactSolverKind::faceted ? Json(settings.facets) : Json()},
       {"start", solved.start},
       {"tolerance", settings.tolerance},
       {"converged", solved.report.converged},
       {"residual", j.residual},
       {"iterations", solved.report.sweeps},
       {"seconds", solved.seconds},
       {"stick", j.stick},
       {"slip", j.slip},
       {"open", j.open},
       {"penetration", j.penetration},
       {"cone_violation", j.cone_violation},
       {"output", options.output.empty() ? Json() : Json(options.output)},
       {"issue", issue ? issue_json(*issue) : Json()}});
  return document;
}

std::string summary_text(const FclibProblem& file, const Solved& solved,
                         const ContactProblemSettings& settings) {
  const ContactJudgement& j = solved.judgement;
  return std::to_string(file.problem.contact_count()) + " contacts, " +
         std::to_string(file.problem.w.row.size()) + " blocks, solver " + solver_text(settings.solver) +
         (solved.start > 0 ? ", from guess " + std::to_string(solved.start) : "") + "\nresidual " +
         rounded_text(j.residual, 3) + " after " + std::to_string(solved.report.sweeps) +
         " iterations, " + rounded_text(1e3 * solved.seconds, 3) + " ms\nstick " +
         std::to_string(j.stick) + ", slip " + std::to_string(j.slip) + ", open " +
         std::to_string(j.open) + "\npenetration " + rounded_text(j.penetration, 3) +
         " (unit of q), cone violation " + rounded_text(j.cone_violation, 3) + " (unit of r)\n";
}

Status present(const CommandLine& line, const Json& document, const std::string& summary) {
  if (line.common().json) return print_json(document);
  if (line.common().quiet) return {};
  return print_data(summary);
}

}  // namespace

Result<ExitCode> run_solve_contact(const Arguments& arguments) {
  SolveContactOptions options;
  CommandLine line("solve-contact",
                   "Solves a problem of frictional contact in FCLIB's local layout: u = W r + q on the "
                   "exact cone.");
  options.add_to(line.app());
  const auto parsed = line.parse(arguments);
  if (!parsed) return parsed.issue();
  if (*parsed == ParseOutcome::help_printed) return ExitCode::ok;
  const auto limits = limits_of(options);
  if (!limits) return limits.issue();
  if (!options.output.empty())
    if (auto status = check_output_file(options.output); !status) return status.issue();
  Console console(line.common().verbosity());

  auto file = read_contact_problem(options.file);
  if (!file) return file.issue();
  const InterruptFlag interrupt;
  const Solved solved = solve(*file, *limits, interrupt);
  const auto issue = shortfall(solved, limits->settings, options.file);
  const Json document = document_of(options, *file, solved, limits->settings, issue);
  const std::string summary = summary_text(*file, solved, limits->settings);
  if (!options.output.empty()) {
    file->solution = ContactState{solved.u, solved.r};
    if (auto status = write_fclib(*file, options.output); !status) return status.issue();
  }
  const Status printed = present(line, document, summary);
  interrupt.pass_on();
  // With --json the shortfall is in the document.
  if (issue) {
    console.issue(*issue);
    return exit_code_of(issue->code);
  }
  if (!printed) return printed.issue();
  return ExitCode::ok;
}

}  // namespace souple
