// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

#include "tools/cli/console.hpp"
#include "tools/recipe/stages.hpp"

namespace souple {

/// Stages and fractions on the terminal.
class ConsoleProgress : public ProgressSink {
 public:
  explicit ConsoleProgress(Console& console) : console_(console) {}
  void stage(std::string_view name) override {
    name_ = name;
    console_.detail("stage " + name_);
    fraction(0);
  }
  void fraction(double done) override { console_.progress(name_, done); }

 private:
  Console& console_;
  std::string name_;
};

}  // namespace souple
