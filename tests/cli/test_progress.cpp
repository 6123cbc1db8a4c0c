// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>

#include "tools/commands/console_progress.hpp"

namespace souple {
namespace {

TEST(TimeLeft, GrowsFromSecondsToHours) {
  EXPECT_EQ(time_left_text(10, 0.5), "10 s left");
  EXPECT_EQ(time_left_text(30, 0.1), "4 min 30 s left");
  EXPECT_EQ(time_left_text(3600, 0.25), "3 h 0 min left");
}

TEST(TimeLeft, SaysNothingWithoutGround) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double done : {0.0, 1.0, -0.5, 1.5, nan, 1e-300}) EXPECT_EQ(time_left_text(10, done), "");
  EXPECT_EQ(time_left_text(1, 0.5), "") << "too early to guess";
  EXPECT_EQ(time_left_text(nan, 0.5), "");
}

}  // namespace
}  // namespace souple
