// SPDX-License-Identifier: GPL-3.0-or-later
// The liver of the drop benchmark folded over its ball: where it comes to rest by the exact method,
// warping makes part of it more than twice too stiff, and forces fed forward would overshoot more with
// every step.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/bench/liver.hpp"

namespace souple {
namespace {

using namespace bench;

TEST(FoldedRest, IsKeptByWarpedContact) {
  const auto liver = baked_liver(1300, 1);
  WorldSettings settings;
  DropScene warped = make_drop(liver, settings);
  settings.contact_method = ContactMethod::exact;
  DropScene exact = make_drop(liver, settings);
  for (int k = 0; k < 400; ++k) ASSERT_TRUE(exact.world.step().ok());
  ASSERT_TRUE(warped.world.copy_state(exact.world).ok());
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(warped.world.step().ok());
  double moved = 0;
  for (std::size_t n = 0; n < warped.world.positions(warped.body).size(); ++n)
    moved = std::max(moved, (as_vec3(warped.world.positions(warped.body)[n]) -
                             as_vec3(exact.world.positions(exact.body)[n]))
                                .norm());
  EXPECT_LT(moved, 1e-5 * liver->longest_side_m());
}

}  // namespace
}  // namespace souple
