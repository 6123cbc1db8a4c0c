// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/volume/sound_volume.hpp"

namespace souple {
namespace {

TEST(TetrahedralizeLarge, FillsALiver) {
  SOUPLE_NEEDS_REAL_SURFACES();
  expect_sound_volume("liver-smooth.obj", 50'000, 0.006, 0.003);
}

TEST(TetrahedralizeLarge, FillsADinosaur) {
  SOUPLE_NEEDS_REAL_SURFACES();
  expect_sound_volume("dino.off", 50'000, 0.012, 0.004);
}

TEST(TetrahedralizeLarge, FillsABunny) {
  SOUPLE_NEEDS_REAL_SURFACES();
  expect_sound_volume("bunny_10k.obj", 50'000, 0.008, 0.005);
}

TEST(TetrahedralizeLarge, FillsASharpMachinePart) {
  SOUPLE_NEEDS_REAL_SURFACES();
  expect_sound_volume("anchor.off", 50'000, 0.004, 0.005);
}

}  // namespace
}  // namespace souple
