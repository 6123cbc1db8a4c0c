// SPDX-License-Identifier: GPL-3.0-or-later
// What a verb of the command line is. Every verb has one file in tools/commands.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/core/result.hpp"
#include "tools/cli/exit_codes.hpp"

namespace souple {

/// The words after the verb.
using Arguments = std::vector<std::string>;

struct Verb {
  std::string_view name;
  std::string_view summary;
  /// The exit code of a run that came to its end, or the issue that stopped it: the caller prints it.
  Result<ExitCode> (*run)(const Arguments& arguments);
};

/// In the order of --help.
std::span<const Verb> verbs();

Result<ExitCode> run_bake(const Arguments& arguments);
Result<ExitCode> run_repair(const Arguments& arguments);
Result<ExitCode> run_decimate(const Arguments& arguments);
Result<ExitCode> run_tetrahedralize(const Arguments& arguments);
Result<ExitCode> run_hierarchy(const Arguments& arguments);
Result<ExitCode> run_precompute(const Arguments& arguments);
Result<ExitCode> run_inspect(const Arguments& arguments);
Result<ExitCode> run_validate(const Arguments& arguments);
Result<ExitCode> run_export(const Arguments& arguments);
Result<ExitCode> run_simulate(const Arguments& arguments);
Result<ExitCode> run_solve_contact(const Arguments& arguments);
Result<ExitCode> run_explain(const Arguments& arguments);

}  // namespace souple
