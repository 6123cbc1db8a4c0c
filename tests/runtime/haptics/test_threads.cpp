// SPDX-License-Identifier: MIT
// Two threads that never wait for each other, and values that are never torn.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include "runtime/haptics/tick_counters.hpp"
#include "runtime/haptics/triple_buffer.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/tool_scenes.hpp"

namespace souple {
namespace {

using namespace test;

struct Payload {
  std::uint64_t number = 0;
  std::vector<std::uint64_t> words = std::vector<std::uint64_t>(4096);
};

TEST(TripleBuffer, ReaderSeesWholeValuesInTheirOrderAndTheLastOne) {
  TripleBuffer<Payload> buffer;
  constexpr std::uint64_t last = 20000;
  std::thread writer([&] {
    for (std::uint64_t k = 1; k <= last; ++k) {
      Payload& slot = buffer.back();
      slot.number = k;
      for (std::size_t w = 0; w < slot.words.size(); ++w) slot.words[w] = k * 2654435761u + w;
      buffer.publish();
    }
  });
  std::uint64_t seen = 0, torn = 0, backwards = 0;
  while (seen < last) {
    if (!buffer.take()) continue;
    const Payload& slot = buffer.front();
    backwards += slot.number <= seen;
    seen = slot.number;
    for (std::size_t w = 0; w < slot.words.size(); ++w) torn += slot.words[w] != seen * 2654435761u + w;
  }
  writer.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(backwards, 0u);
  EXPECT_FALSE(buffer.take());
}

// A tick solves a problem to its laws only if nobody writes into it meanwhile.
TEST(HapticThreads, TicksAndStepsHammerEachOtherWithoutATornProblem) {
  WorldSettings world_settings;
  World world = make_world(world_settings);
  add_soft(world,
           make_body(box_mesh({2, 3, 2}, {-0.02, -0.02, -0.02}, {0.04, 0.04, 0.04}),
                     material_of(1e4, 0.4, 1000, 0.1, 0.01), 0.01),
           {0, 0, 0.02});
  add_plane(world);
  HandleCoupling coupling;
  Tool tool = add_forceps(world, coupling, {-0.1, 0, 0.022}, 0.5);
  HapticSettings settings;
  settings.tick_budget_s = INFINITY;
  settings.residual_goal = 1e-3;
  settings.max_sweeps = 100000;
  auto channel = make_channel(std::move(tool), settings);
  std::atomic<bool> done{false};
  std::atomic<int> not_finite{0}, unsolved{0};
  std::thread hand([&] {
    for (int k = 0; !done; ++k) {
      const double t = 0.001 * k, closing = 0.34 + 0.1 * std::cos(0.002 * k);
      const Wrench wrench =
          channel.tick(sample_at(t, {-0.1, 0.001 * std::sin(3 * t), 0.022}, Mat3::Identity(), closing));
      not_finite += !force_of(wrench).allFinite();
      unsolved += channel.residual() > 1e-3;
    }
  });
  std::uint64_t ticks = 0;
  for (int k = 0; k < 300; ++k) {
    physics_step(world, channel);
    const std::uint64_t now = channel.telemetry().ticks;
    EXPECT_GE(now, ticks);
    ticks = now;
  }
  done = true;
  hand.join();
  EXPECT_EQ(not_finite, 0);
  EXPECT_EQ(unsolved, 0);
  EXPECT_EQ(channel.telemetry().publications, 300u);
  EXPECT_GT(channel.telemetry().hand_overs, 0u);
}

TEST(HapticTelemetry, HistogramsHoldWhatWasCounted) {
  HistogramCounter counter(HapticTelemetry{}.tick_time_s);
  for (int k = 1; k <= 1000; ++k) counter.add(1e-6 * k);
  counter.add(0);
  counter.add(1e9);
  const LogHistogram histogram = counter.read();
  EXPECT_EQ(histogram.total(), 1002u);
  EXPECT_EQ(histogram.count.front(), 1u);
  EXPECT_EQ(histogram.count.back(), 1u);
  EXPECT_GE(histogram.quantile(0.5), 500e-6);
  EXPECT_LE(histogram.quantile(0.5), 500e-6 * histogram.ratio * 1.01);
  EXPECT_EQ(LogHistogram{}.quantile(0.5), 0);
}

}  // namespace
}  // namespace souple
