// SPDX-License-Identifier: GPL-3.0-or-later
// The table of the contact stress: a line for each case, and how many of them fall short.
#include <algorithm>
#include <cstdio>

#include "tests/bench/row.hpp"
#include "tests/support/contact_stress_cases.hpp"

int main() {
  const auto outcomes = souple::test::run_contact_stress();
  double cone = 0, bad = 0;
  souple::bench::ResultHash hash;
  for (const auto& outcome : outcomes) {
    std::printf("%s\n", souple::test::describe(outcome).c_str());
    cone = std::max(cone, outcome.cone_violation);
    bad += outcome.is_good() ? 0 : 1;
    hash.add(std::vector<double>{outcome.worst_penetration_m, outcome.energy_gain});
  }
  souple::bench::print_row("contact-stress.cases", "1", double(outcomes.size()), hash);
  souple::bench::print_row("contact-stress.bad", "1", bad, hash);
  souple::bench::print_row("contact-stress.cone", "1", cone, hash);
}
