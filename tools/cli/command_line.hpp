// SPDX-License-Identifier: GPL-3.0-or-later
// The command line of one verb, on top of CLI11.
#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include "tools/cli/console.hpp"
#include "tools/cli/verb.hpp"

namespace souple {

/// Options that every verb has.
struct CommonOptions {
  bool quiet = false;
  bool verbose = false;
  bool json = false;

  Verbosity verbosity() const {
    return quiet ? Verbosity::quiet : verbose ? Verbosity::verbose : Verbosity::normal;
  }
};

enum class ParseOutcome { proceed, help_printed };

class CommandLine {
 public:
  CommandLine(const std::string& verb, const std::string& summary);

  CLI::App& app() { return app_; }
  const CommonOptions& common() const { return common_; }
  /// Refuses unknown options, with the nearest known one. Prints --help on stdout.
  /// Issues: usage_unknown_option, usage_bad_value, usage_missing_argument, usage_conflict.
  Result<ParseOutcome> parse(const Arguments& arguments);

 private:
  Issue unknown(const std::string& word) const;

  CLI::App app_;
  CommonOptions common_;
};

/// `text` as a whole number in [min, max]. Issue usage_bad_value.
Result<std::int64_t> integer_option(const std::string& option, const std::string& text,
                                    std::int64_t min, std::int64_t max);

}  // namespace souple
