// SPDX-License-Identifier: GPL-3.0-or-later
// Talk with people: on stderr, so that stdout carries data only.
#pragma once
#include <string>
#include <string_view>

#include "formats/core/issue.hpp"

namespace souple {

enum class Verbosity { quiet, normal, verbose };

class Console {
 public:
  explicit Console(Verbosity verbosity);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  bool verbose() const { return verbosity_ == Verbosity::verbose; }
  void say(std::string_view line);     ///< unless quiet
  void detail(std::string_view line);  ///< only if verbose
  void issue(const Issue& issue);      ///< errors always; notes and warnings unless quiet
  /// A progress line, `more` at its end, that overwrites itself; nothing unless stderr is a terminal,
  /// and not if quiet.
  void progress(std::string_view label, double fraction, std::string_view more = {});
  void end_progress();

 private:
  void print(std::string_view line);
  std::string painted(std::string_view text, Severity severity) const;

  Verbosity verbosity_;
  bool terminal_;  ///< stderr is one
  bool colour_;    ///< terminal, and NO_COLOR is not set (no-color.org)
  bool progress_shown_ = false;
  int last_percent_ = -1;
  std::string last_label_, last_more_;
};

}  // namespace souple
