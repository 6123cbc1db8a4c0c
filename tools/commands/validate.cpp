// SPDX-License-Identifier: GPL-3.0-or-later
// souple validate ASSET: checks everything, lists what is wrong.
#include "formats/read/validate.hpp"

#include <algorithm>
#include <optional>

#include "tools/cli/command_line.hpp"
#include "tools/cli/json_output.hpp"
#include "tools/commands/compliance_options.hpp"
#include "tools/commands/deep_validation.hpp"

namespace souple {
namespace {

constexpr std::int64_t most_issues = 100000;

/// The first error decides: what follows it may only be its consequence.
ExitCode verdict(const ValidationReport& report) {
  const auto error = std::ranges::find(report.issues, Severity::error, &Issue::severity);
  return error == report.issues.end() ? ExitCode::ok : exit_code_of(error->code);
}

std::string report_text(const ValidationReport& report, const std::string& file) {
  std::string text;
  std::size_t number = 0;
  for (const Issue& issue : report.issues)
    text += std::to_string(++number) + ". " + format_issue(issue) + "\n";
  if (report.suppressed_count > 0) text += "and " + std::to_string(report.suppressed_count) + " more\n";
  const std::size_t count = report.issues.size() + report.suppressed_count;
  return text + file + ": " + (report.valid() ? "valid" : "not valid") + ", " + std::to_string(count) +
         (count == 1 ? " issue\n" : " issues\n");
}

Json report_json(const ValidationReport& report, const std::string& file,
                 const std::optional<std::vector<DeepResult>>& deep) {
  Json document = schema_header("validate");
  document["file"] = file;
  document["valid"] = report.valid();
  document["issues"] = Json::array();
  for (const Issue& issue : report.issues) document["issues"].push_back(issue_json(issue));
  document["suppressed_count"] = report.suppressed_count;
  if (deep) document["deep"] = deep_json(*deep);
  document["exit_code"] = static_cast<int>(verdict(report));
  return document;
}

}  // namespace

Result<ExitCode> run_validate(const Arguments& arguments) {
  std::string file;
  std::string cap_text = "100";
  bool is_deep = false;
  EffortOptions effort_options;
  CommandLine line("validate", "Checks structure, values, checksums and the hash of the content.");
  line.app().add_option("ASSET", file, "the .souple file")->required();
  line.app().add_option("--max-issues", cap_text, "list at most so many (100)");
  line.app().add_flag("--deep", is_deep,
                      "also rebuild the system of every compliance and measure its errors again");
  effort_options.add_to(line.app());
  const auto parsed = line.parse(arguments);
  if (!parsed) return parsed.issue();
  if (*parsed == ParseOutcome::help_printed) return ExitCode::ok;
  const auto cap = integer_option("--max-issues", cap_text, 1, most_issues);
  if (!cap) return cap.issue();
  const auto effort = effort_options.stage();
  if (!effort) return effort.issue();
  const ValidationOptions options{static_cast<std::size_t>(*cap)};
  ValidationReport report = validate_asset_file(file, options);
  std::optional<std::vector<DeepResult>> deep;
  if (is_deep && report.valid()) {
    Console console(line.common().verbosity());
    deep = validate_deeply(file, *effort, console, options, report);
  }
  const Status printed = line.common().json ? print_json(report_json(report, file, deep))
                         : line.common().quiet
                             ? Status{}
                             : print_data((deep ? deep_text(*deep) : "") + report_text(report, file));
  if (!printed) return printed.issue();
  return verdict(report);
}

}  // namespace souple
