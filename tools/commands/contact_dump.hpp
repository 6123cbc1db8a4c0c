// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "formats/core/result.hpp"
#include "formats/fclib/fclib_problem.hpp"

namespace souple {

class World;
struct StepContactProblem;

/// The contact problem of a step in the terms of FCLIB, which knows no joints: bilateral rows b are
/// condensed out, W = W_cc - W_cb W_bb^+ W_bc and q = q_c - W_cb W_bb^+ q_b, which leaves the forces of
/// the contacts as they are. The forces of the step are its solution. Issue contact_problem_invalid:
/// no contacts, or without W (penalty).
Result<FclibProblem> fclib_problem_of(const StepContactProblem& step, std::string title);

/// Where `--dump-contact STEP=FILE` writes what.
struct ContactDump {
  std::int64_t step = 0;
  std::string file;
};

/// Issues: usage_bad_value; those of check_output_file.
Result<ContactDump> parse_contact_dump(const std::string& text, std::int64_t step_count);

/// Writes the problem of the world's last step. Issues: those of fclib_problem_of and write_fclib.
Status write_contact_dump(const World& world, const ContactDump& dump);

}  // namespace souple
