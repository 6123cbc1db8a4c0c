// SPDX-License-Identifier: MIT
// Contact under conditions that no scene should have: each case is run and judged in plain units.
#pragma once
#include <string>
#include <vector>

#include "runtime/world/step_report.hpp"

namespace souple::test {

struct ContactStressOutcome {
  std::string name;
  double worst_penetration_m = 0;  ///< once an overlap has to be resolved
  double cone_violation = 0;       ///< worst, relative to the largest force
  double energy_gain = 0;  ///< most that was there beyond the start and what was put in, over it
  std::size_t most_contacts = 0;
  double allowed_penetration_m = 0, allowed_gain = 0;
  std::string refused;  ///< the issue of a step or a body that was refused; empty: none

  bool is_good() const {
    return refused.empty() && worst_penetration_m <= allowed_penetration_m && cone_violation <= 1e-9 &&
           energy_gain <= allowed_gain;
  }
};

/// Runs all cases, which takes some seconds.
std::vector<ContactStressOutcome> run_contact_stress();
/// One line.
std::string describe(const ContactStressOutcome& outcome);

}  // namespace souple::test
