// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/json_output.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "tools/cli/exit_codes.hpp"

namespace souple {

Json schema_header(std::string_view name) {
  return {{"schema", "souple." + std::string(name)}, {"schema_version", 1}};
}

Json issue_json(const Issue& issue) {
  static constexpr std::array<const char*, 3> severities{"note", "warning", "error"};
  return {{"code", issue_code_text(issue.code)},
          {"name", issue_entry(issue.code).name},
          {"severity", severities[static_cast<std::size_t>(issue.severity)]},
          {"what", issue.what},
          {"where", issue.where},
          {"mend", mend_of(issue)},
          {"exit_code", static_cast<int>(exit_code_of(issue.code))}};
}

Json stopped_json(const Issue& issue) {
  Json document = schema_header("issue");
  document["issue"] = issue_json(issue);
  return document;
}

std::string json_text(const Json& document) {
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Status print_data(std::string_view text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (written && std::fflush(stdout) == 0) return {};
  return make_issue(IssueCode::io_cannot_write, std::string("cannot write: ") + std::strerror(errno),
                    "standard output");
}

Status print_json(const Json& document) { return print_data(json_text(document)); }

}  // namespace souple
