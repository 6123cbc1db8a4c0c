// SPDX-License-Identifier: GPL-3.0-or-later
// Every case of the contact stress ends bounded, inside the cone and outside of other bodies.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/contact_stress_cases.hpp"

namespace souple {
namespace {

TEST(ContactStress, EveryCaseEndsBoundedAndApart) {
  for (const auto& outcome : test::run_contact_stress()) {
    const std::string line = test::describe(outcome);
    std::printf("%s\n", line.c_str());
    EXPECT_TRUE(outcome.refused.empty()) << line;
    EXPECT_LE(outcome.cone_violation, 1e-9) << line;
    EXPECT_LE(outcome.worst_penetration_m, outcome.allowed_penetration_m) << line;
    EXPECT_LE(outcome.energy_gain, outcome.allowed_gain) << line;
  }
}

}  // namespace
}  // namespace souple
