// SPDX-License-Identifier: GPL-3.0-or-later
// souple explain [CODE]: what a code means and how to mend it.
#include <optional>

#include "tools/cli/command_line.hpp"
#include "tools/cli/json_output.hpp"
#include "tools/exchange/nearest_name.hpp"

namespace souple {
namespace {

Json entry_json(const IssueEntry& entry) {
  return {{"code", issue_code_text(entry.code)},
          {"name", entry.name},
          {"exit_code", static_cast<int>(exit_code_of(entry.code))},
          {"title", entry.title},
          {"explanation", entry.explanation},
          {"mend", entry.mend}};
}

std::string exit_meaning(IssueCode code) {
  for (const auto& entry : exit_code_table)
    if (entry.code == exit_code_of(code)) return std::string(entry.meaning);
  return {};
}

std::string entry_text(const IssueEntry& entry) {
  return issue_code_text(entry.code) + " " + std::string(entry.name) + ": " + std::string(entry.title) +
         "\n\n" + std::string(entry.explanation) + "\n\nMend: " + std::string(entry.mend) +
         "\nExit code: " + std::to_string(static_cast<int>(exit_code_of(entry.code))) + " (" +
         exit_meaning(entry.code) + ")\n";
}

/// By number ("S3001", "3001") or by name ("surface_not_finite").
Result<std::vector<const IssueEntry*>> entries_for(const std::optional<std::string>& asked) {
  std::vector<const IssueEntry*> entries;
  std::vector<std::string> known;
  for (const IssueEntry& entry : issue_catalogue()) {
    if (!asked || *asked == entry.name) entries.push_back(&entry);
    known.push_back(issue_code_text(entry.code));
    known.emplace_back(entry.name);
  }
  if (!entries.empty()) return entries;
  if (const IssueEntry* entry = find_issue_entry(*asked)) return std::vector{entry};
  const std::string near = nearest_name(*asked, known);
  return make_issue(
      IssueCode::usage_bad_value, "there is no code \"" + *asked + "\"", "souple explain",
      (near.empty() ? "" : "Did you mean " + near + "? ") + "`souple explain` lists all codes.");
}

Status print_entries(const std::vector<const IssueEntry*>& entries, bool one, bool json) {
  if (json) {
    Json document = schema_header("explain");
    document["codes"] = Json::array();
    for (const IssueEntry* entry : entries) document["codes"].push_back(entry_json(*entry));
    return print_json(document);
  }
  if (one) return print_data(entry_text(*entries.front()));
  std::string text;
  for (const IssueEntry* entry : entries)
    text += issue_code_text(entry->code) + "  " + std::string(entry->title) + "\n";
  return print_data(text);
}

}  // namespace

Result<ExitCode> run_explain(const Arguments& arguments) {
  std::optional<std::string> asked;
  CommandLine line("explain", "What a code means and how to mend it; without CODE, all codes.");
  line.app().add_option("CODE", asked, "e.g. S3001");
  const auto parsed = line.parse(arguments);
  if (!parsed) return parsed.issue();
  if (*parsed == ParseOutcome::help_printed) return ExitCode::ok;
  const auto entries = entries_for(asked);
  if (!entries) return entries.issue();
  if (auto status = print_entries(*entries, asked.has_value(), line.common().json); !status)
    return status.issue();
  return ExitCode::ok;
}

}  // namespace souple
