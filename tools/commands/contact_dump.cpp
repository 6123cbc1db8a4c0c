// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/contact_dump.hpp"

#include <Eigen/Dense>

#include "formats/fclib/write_fclib.hpp"
#include "runtime/contact/contact.hpp"
#include "runtime/contact/contact_judgement.hpp"
#include "runtime/world/world.hpp"
#include "tools/cli/command_line.hpp"
#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/numbers.hpp"

namespace souple {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Rows = std::vector<Eigen::Index>;

/// Rows of the constraints of one kind.
Rows rows_of(const StepContactProblem& step, ConstraintLaw::Kind kind) {
  Rows rows;
  for (std::size_t i = 0; i < step.laws.size(); ++i)
    if (step.laws[i].kind == kind)
      for (std::size_t k = 0; k < 3; ++k) rows.push_back(static_cast<Eigen::Index>(3 * i + k));
  return rows;
}

Status check_step(const StepContactProblem& step, const Rows& contacts) {
  const std::size_t size = 3 * step.laws.size();
  if (contacts.empty())
    return make_issue(IssueCode::contact_problem_invalid, "the step has no contacts", "",
                      "Choose a step in which bodies touch: the samples of the report tell.");
  if (step.delassus.size() != size * size)
    return make_issue(IssueCode::contact_problem_invalid,
                      "penalty contacts have no problem to be solved", "",
                      "Use contact_method \"warped\" or \"exact\".");
  return {};
}

}  // namespace

Result<FclibProblem> fclib_problem_of(const StepContactProblem& step, std::string title) {
  const Rows contacts = rows_of(step, ConstraintLaw::Kind::frictional);
  const Rows joints = rows_of(step, ConstraintLaw::Kind::bilateral);
  if (auto status = check_step(step, contacts); !status) return status.issue();
  const auto size = static_cast<Eigen::Index>(step.free_gap.size());
  const Eigen::Map<const RowMajor> all(step.delassus.data(), size, size);
  const Eigen::Map<const Eigen::VectorXd> free_gap(step.free_gap.data(), size);
  Eigen::MatrixXd w = all(contacts, contacts);
  Eigen::VectorXd q = free_gap(contacts);
  if (!joints.empty()) {
    // Redundant joints leave W_bb singular: the least squares answer is one of its inverses.
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> joined(
        Eigen::MatrixXd(all(joints, joints)));
    const Eigen::MatrixXd coupling = all(contacts, joints);
    w -= coupling * joined.solve(Eigen::MatrixXd(all(joints, contacts)));
    q -= coupling * joined.solve(Eigen::VectorXd(free_gap(joints)));
  }
  FclibProblem file;
  file.problem.title = std::move(title);
  file.problem.description = "rows: normal, two tangents; forces in N, gaps in m" +
                             std::string(joints.empty() ? "" : "; joints condensed out");
  file.problem.math_info = "W = H C H^T, q the gap and slip that no contact force would leave";
  file.problem.w =
      block_columns_of_dense({w.data(), static_cast<std::size_t>(w.size())}, contacts.size() / 3);
  file.problem.q.assign(q.begin(), q.end());
  ContactState solution;
  for (const Eigen::Index row : contacts)
    solution.r.push_back(step.force[static_cast<std::size_t>(row)]);
  for (const ConstraintLaw& law : step.laws)
    if (law.kind == ConstraintLaw::Kind::frictional) file.problem.mu.push_back(law.friction);
  if (auto status = check_contact_problem(file.problem); !status) return status.issue();
  solution.u = gap_of(file.problem, solution.r);
  file.solution = std::move(solution);
  return file;
}

Result<ContactDump> parse_contact_dump(const std::string& text, std::int64_t step_count) {
  const std::size_t mark = text.find('=');
  if (mark == std::string::npos || mark + 1 == text.size())
    return make_issue(IssueCode::usage_bad_value, "\"" + text + "\" is not STEP=FILE", "--dump-contact",
                      "Give a step and a file, as in 120=contacts.hdf5.");
  const auto step = integer_option("--dump-contact", text.substr(0, mark), 1, step_count);
  if (!step) return step.issue();
  ContactDump dump{*step, text.substr(mark + 1)};
  if (auto status = check_output_file(dump.file); !status) return status.issue();
  return dump;
}

Status write_contact_dump(const World& world, const ContactDump& dump) {
  const auto file =
      fclib_problem_of(world.contact_problem(),
                       "contacts of a step that ends at " + rounded_text(world.time_s(), 9) + " s");
  if (!file) {
    Issue issue = file.issue();
    issue.where = "step " + std::to_string(dump.step);
    return issue;
  }
  return write_fclib(*file, dump.file);
}

}  // namespace souple
