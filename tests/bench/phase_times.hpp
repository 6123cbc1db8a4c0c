// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "runtime/world/step_report.hpp"
#include "tests/bench/row.hpp"

namespace souple::bench {

/// Wall times of steps by phase, as rows.
class PhaseRows {
 public:
  void add(const StepReport& step) {
    free_.push_back(step.times.free_motion_s);
    collision_.push_back(step.times.collision_s);
    compliance_.push_back(step.times.compliance_s);
    solve_.push_back(step.times.contact_solve_s);
    correction_.push_back(step.times.correction_s);
    step_.push_back(step.times.total_s);
    contact_.push_back(step.times.total_s - step.times.free_motion_s);
    contacts_.push_back(double(step.contact_count));
    active_.push_back(double(step.active_count));
  }
  const std::vector<double>& compliance_s() const { return compliance_; }

  /// NAME.step, NAME.contact_step (all but the free motion), NAME.phase.*, NAME.contacts, NAME.active.
  void print(const std::string& name, const ResultHash& hash) const {
    print_row(name + ".step", "ms", step_, hash, 1e3);
    print_row(name + ".contact_step", "ms", contact_, hash, 1e3);
    print_row(name + ".phase.free_motion", "ms", free_, hash, 1e3);
    print_row(name + ".phase.collision", "ms", collision_, hash, 1e3);
    print_row(name + ".phase.compliance", "ms", compliance_, hash, 1e3);
    print_row(name + ".phase.contact_solve", "ms", solve_, hash, 1e3);
    print_row(name + ".phase.correction", "ms", correction_, hash, 1e3);
    print_row(name + ".contacts", "1", contacts_, hash);
    print_row(name + ".active", "1", active_, hash);
  }

 private:
  std::vector<double> free_, collision_, compliance_, solve_, correction_, step_, contact_;
  std::vector<double> contacts_, active_;
};

}  // namespace souple::bench
