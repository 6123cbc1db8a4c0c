// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/command_line.hpp"

#include <algorithm>
#include <cstdio>

#include "tools/exchange/nearest_name.hpp"
#include "tools/exchange/numbers.hpp"

namespace souple {
namespace {

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

Issue usage_issue(const CLI::ParseError& error, const std::string& command) {
  const auto code =
      dynamic_cast<const CLI::RequiredError*>(&error) != nullptr   ? IssueCode::usage_missing_argument
      : dynamic_cast<const CLI::ExcludesError*>(&error) != nullptr ? IssueCode::usage_conflict
                                                                   : IssueCode::usage_bad_value;
  return make_issue(code, error.what(), command,
                    "Run `" + command + " --help` for what the verb needs.");
}

}  // namespace

CommandLine::CommandLine(const std::string& verb, const std::string& summary)
    : app_(summary, "souple " + verb) {
  app_.footer("\n" + exit_codes_text());
  app_.allow_extras();
  app_.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::Throw);
  auto* quiet = app_.add_flag("-q,--quiet", common_.quiet, "say nothing but errors");
  app_.add_flag("-v,--verbose", common_.verbose, "say more")->excludes(quiet);
  app_.add_flag("--json", common_.json, "print the report, or the issue, as JSON on stdout");
}

Issue CommandLine::unknown(const std::string& word) const {
  const std::string name = word.substr(0, word.find('='));
  if (!word.starts_with('-'))
    return make_issue(IssueCode::usage_unknown_option, "one argument too many: \"" + word + "\"",
                      app_.get_name());
  const std::string near = nearest_name(name, option_names(app_));
  return make_issue(IssueCode::usage_unknown_option, "unknown option \"" + name + "\"", app_.get_name(),
                    (near.empty() ? "" : "Did you mean " + near + "? ") + "Run `" + app_.get_name() +
                        " --help` for the options.");
}

Result<ParseOutcome> CommandLine::parse(const Arguments& arguments) {
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    app_.parse(reversed);
  } catch (const CLI::CallForHelp&) {
    std::fputs(app_.help().c_str(), stdout);
    return ParseOutcome::help_printed;
  } catch (const CLI::ParseError& error) {
    // A misspelt option is why a required one is missing: name the cause.
    const auto extras = app_.remaining();
    const auto option = std::ranges::find_if(extras, [](const auto& e) { return e.starts_with('-'); });
    if (option != extras.end()) return unknown(*option);
    return usage_issue(error, app_.get_name());
  }
  if (const auto extras = app_.remaining(); !extras.empty()) return unknown(extras.front());
  return ParseOutcome::proceed;
}

Result<std::int64_t> integer_option(const std::string& option, const std::string& text,
                                    std::int64_t min, std::int64_t max) {
  const auto value = parse_integer(text);
  if (value && *value >= min && *value <= max) return *value;
  const std::string wanted =
      "a whole number from " + std::to_string(min) + " to " + std::to_string(max);
  return make_issue(IssueCode::usage_bad_value,
                    "\"" + text + "\" cannot be used: " + wanted + " is wanted", option,
                    "Give " + wanted + ".");
}

}  // namespace souple
