// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/console.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace souple {
namespace {

constexpr int bar_width = 30;

bool wants_colour() {
  const char* no_colour = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  return (no_colour == nullptr || *no_colour == '\0') &&
         (terminal == nullptr || std::string_view(terminal) != "dumb");
}

/// Control characters from file names and keys must not steer the terminal.
std::string harmless(std::string_view text) {
  std::string result;
  for (const char c : text)
    result += static_cast<unsigned char>(c) < 32 && c != '\n' ? '?' : c == 127 ? '?' : c;
  return result;
}

}  // namespace

Console::Console(Verbosity verbosity)
    : verbosity_(verbosity),
      terminal_(::isatty(STDERR_FILENO) == 1),
      colour_(terminal_ && wants_colour()) {}

Console::~Console() { end_progress(); }

void Console::print(std::string_view line) {
  end_progress();
  std::fwrite(line.data(), 1, line.size(), stderr);
  std::fputc('\n', stderr);
}

void Console::say(std::string_view line) {
  if (verbosity_ != Verbosity::quiet) print(harmless(line));
}

void Console::detail(std::string_view line) {
  if (verbosity_ == Verbosity::verbose) print(harmless(line));
}

std::string Console::painted(std::string_view text, Severity severity) const {
  std::string plain = harmless(text);
  if (!colour_) return plain;
  const char* paint = severity == Severity::error     ? "\033[1;31m"
                      : severity == Severity::warning ? "\033[1;33m"
                                                      : "\033[1;36m";
  // The severity and the code, up to the first colon.
  const std::size_t end = std::min(plain.find(':'), plain.size());
  return paint + plain.substr(0, end) + "\033[0m" + plain.substr(end);
}

void Console::issue(const Issue& issue) {
  if (verbosity_ == Verbosity::quiet && issue.severity != Severity::error) return;
  print(painted(format_issue(issue), issue.severity));
}

void Console::progress(std::string_view label, double fraction, std::string_view more) {
  if (!terminal_ || verbosity_ == Verbosity::quiet) return;
  const int percent = static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0));
  if (progress_shown_ && percent == last_percent_ && label == last_label_ && more == last_more_) return;
  last_percent_ = percent;
  last_label_ = label;
  last_more_ = more;
  const auto filled = static_cast<std::size_t>(bar_width * percent / 100);
  const std::string bar = std::string(filled, '#') + std::string(bar_width - filled, '.');
  std::fprintf(stderr, "\r\033[K%-14s [%s] %3d %% %s", last_label_.c_str(), bar.c_str(), percent,
               last_more_.c_str());
  std::fflush(stderr);
  progress_shown_ = true;
}

void Console::end_progress() {
  if (!progress_shown_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  progress_shown_ = false;
}

}  // namespace souple
