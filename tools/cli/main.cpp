// SPDX-License-Identifier: GPL-3.0-or-later
// souple VERB …: finds the verb, runs it, tells what stopped it. The only place that catches.
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <new>

#include "formats/core/asset.hpp"
#include "tools/cli/console.hpp"
#include "tools/cli/json_output.hpp"
#include "tools/cli/signals.hpp"
#include "tools/cli/verb.hpp"
#include "tools/cli/version.hpp"
#include "tools/exchange/nearest_name.hpp"

namespace souple {

std::span<const Verb> verbs() {
  static constexpr std::array<Verb, 12> table{{
      {"bake", "a surface becomes an asset: mesh, hierarchy, compliances", run_bake},
      {"repair", "what is wrong with a surface, and a solid made of it", run_repair},
      {"decimate", "a surface of fewer triangles", run_decimate},
      {"tetrahedralize", "a closed surface filled with tets", run_tetrahedralize},
      {"hierarchy", "tet meshes become the levels of an asset", run_hierarchy},
      {"precompute", "an asset gets the compliances of a recipe", run_precompute},
      {"inspect", "what is in an asset and what it costs; reads headers only", run_inspect},
      {"validate", "checks everything in an asset", run_validate},
      {"export", "tets or surfaces of an asset for other programs", run_export},
      {"simulate", "runs a scene; writes frames and a report", run_simulate},
      {"solve-contact", "solves a friction-contact problem in FCLIB's layout", run_solve_contact},
      {"explain", "what a code means and how to mend it", run_explain},
  }};
  return table;
}

namespace {

std::string help_text() {
  std::string text =
      "souple: surfaces become precomputed soft bodies in frictional contact\n\n"
      "Usage: souple VERB [options]    souple VERB --help    souple --version\n\nVerbs:\n";
  for (const Verb& verb : verbs()) {
    std::string name(verb.name);
    name.resize(16, ' ');
    text += "  " + name + std::string(verb.summary) + "\n";
  }
  return text + "\n" + exit_codes_text();
}

std::string version_text() {
  return "souple " + std::string(program_version) + " (asset format " +
         std::to_string(asset_version_major) + "." + std::to_string(asset_version_minor) + ")\n";
}

Issue unknown_verb(const std::string& word) {
  std::vector<std::string> names;
  for (const Verb& verb : verbs()) names.emplace_back(verb.name);
  const std::string near = nearest_name(word, names);
  return make_issue(
      IssueCode::usage_unknown_option, "unknown verb \"" + word + "\"", "souple",
      (near.empty() ? "" : "Did you mean " + near + "? ") + "Verbs: " + join_names(names) + ".");
}

Result<ExitCode> print_and_end(const std::string& text) {
  if (auto status = print_data(text); !status) return status.issue();
  return ExitCode::ok;
}

Result<ExitCode> dispatch(const Arguments& words) {
  if (words.empty())
    return make_issue(IssueCode::usage_missing_argument, "no verb was given", "souple",
                      "Run `souple --help` for the verbs.");
  const std::string& first = words.front();
  if (first == "--help" || first == "-h" || first == "help") return print_and_end(help_text());
  if (first == "--version") return print_and_end(version_text());
  const auto verb = std::ranges::find(verbs(), first, &Verb::name);
  if (verb == verbs().end()) return unknown_verb(first);
  return verb->run({words.begin() + 1, words.end()});
}

/// Prints what stopped the run: for people on stderr and, with --json, for programs on stdout.
int tell(const Issue& issue, bool json) {
  Console(Verbosity::normal).issue(issue);
  if (json) (void)print_json(stopped_json(issue));
  return static_cast<int>(exit_code_of(issue.code));
}

int run(int count, char** words) {
  const Arguments arguments(words + std::min(count, 1), words + count);
  const bool json = std::ranges::find(arguments, "--json") != arguments.end();
  try {
    report_write_limits_as_errors();
    const auto result = dispatch(arguments);
    return result ? static_cast<int>(*result) : tell(result.issue(), json);
  } catch (const std::bad_alloc&) {
    return tell(make_issue(IssueCode::io_out_of_memory, "there is not enough memory"), json);
  } catch (const std::exception& error) {
    return tell(make_issue(IssueCode::internal_error, error.what()), json);
  }
}

}  // namespace
}  // namespace souple

int main(int count, char** words) { return souple::run(count, words); }
