// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <cmath>
#include <string>
#include <string_view>

#include "tools/cli/console.hpp"
#include "tools/recipe/stages.hpp"

namespace souple {

/// "3 min 20 s left" of a stage that runs evenly; empty while there is nothing to tell from, and when
/// less than a second is left.
inline std::string time_left_text(double elapsed_s, double done) {
  constexpr double first_guess_s = 2;
  if (elapsed_s < first_guess_s || !(done > 0 && done < 1)) return {};
  const double left_s = std::round(elapsed_s * (1 - done) / done);
  if (!(left_s >= 1 && left_s < 1e7)) return {};
  const long seconds = std::lround(left_s);
  if (seconds < 60) return std::to_string(seconds) + " s left";
  if (seconds < 3600)
    return std::to_string(seconds / 60) + " min " + std::to_string(seconds % 60) + " s left";
  return std::to_string(seconds / 3600) + " h " + std::to_string(seconds % 3600 / 60) + " min left";
}

/// Stages, fractions and the time left on the terminal.
class ConsoleProgress : public ProgressSink {
 public:
  explicit ConsoleProgress(Console& console) : console_(console) {}
  void stage(std::string_view name) override {
    name_ = name;
    begin_ = Clock::now();
    console_.detail("stage " + name_);
    fraction(0);
  }
  void fraction(double done) override {
    const std::chrono::duration<double> elapsed = Clock::now() - begin_;
    console_.progress(name_, done, time_left_text(elapsed.count(), done));
  }

 private:
  using Clock = std::chrono::steady_clock;
  Console& console_;
  std::string name_;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace souple
