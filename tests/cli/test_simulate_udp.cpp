// SPDX-License-Identifier: GPL-3.0-or-later
// `simulate` with a haptic device that is another program, as docs/haptic_device.md has it.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "runtime/haptics_net/udp_device.hpp"
#include "tests/cli/run_souple.hpp"
#include "tests/cli/schema_check.hpp"

namespace souple::test {
namespace {

constexpr double largest_force_n = 0.5;
const Point rest{0, 0, 0.05};

class SimulateUdp : public SoupleCommand {
 protected:
  /// A ball on a floor, held by whoever sends to `port`.
  std::string scene(std::uint16_t port) const {
    return "[world]\ntime_step_s = 0.01\n"
           "[[body]]\nkind = \"soft\"\nname = \"liver\"\nasset = \"" +
           baked_liver().string() +
           "\"\nposition = [0.5, 0, 0.16]\n"
           "[[body]]\nkind = \"rigid\"\nname = \"floor\"\nshape = \"plane\"\n"
           "[[body]]\nkind = \"rigid\"\nname = \"ball\"\nshape = \"sphere\"\nradius_m = 0.05\n"
           "position = [0, 0, 0.05]\n[output]\nframes_every = 1000\n"
           "[[probe]]\nname = \"stylus\"\nbody = \"ball\"\ndevice = \"udp\"\nport = " +
           std::to_string(port) + "\nposition = [0, 0, 0.05]\n";
  }
  std::vector<std::string> words(std::uint16_t port) const {
    return {
        "simulate", write("s.toml", scene(port)).string(), "-o", path("out").string(), "--steps", "60",
        "--json"};
  }
};

std::uint16_t free_port() { return LoopbackSocket::open(0)->port(); }

/// What the program around a device's SDK does, until told to end: presses slowly downwards.
struct Device {
  explicit Device(std::uint16_t port)
      : link(std::move(DeviceLink::open(port)).value()), thread([this] { run(); }) {}
  ~Device() { end(); }
  void end() {
    is_over = true;
    if (thread.joinable()) thread.join();
  }
  void run() {
    DeviceLimits limits;
    limits.force_n = largest_force_n;
    const auto begin = std::chrono::steady_clock::now();
    for (int k = 0; !is_over; ++k) {
      DeviceSample sample;
      sample.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      sample.pose.translation = rest;
      sample.pose.translation[2] -= std::min(0.005, 0.02 * sample.time_s);
      if (k % 100 == 0) link.send_limits(limits);
      link.send_sample(sample);
      Wrench wrench;
      if (link.receive(wrench)) {
        ++received;
        largest_up_n = std::max(largest_up_n, wrench.force_n[2]);
        // The first samples may be read before there are limits.
        if (received > 110) largest_after_n = std::max(largest_after_n, wrench.force_n[2]);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  DeviceLink link;
  std::atomic<bool> is_over = false;
  int received = 0;
  double largest_up_n = 0, largest_after_n = 0;
  std::thread thread;  // last: it uses the others
};

TEST_F(SimulateUdp, AHandInAnotherProgramFeelsTheFloorWithinTheLimitsItDeclared) {
  const std::uint16_t port = free_port();
  Device device(port);
  const auto result = run_souple(words(port));
  device.end();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = result.json();
  EXPECT_EQ(schema_violation(json, load_schema("simulate")), "");
  const auto& probe = json["probes"][0];
  EXPECT_EQ(probe["telemetry"]["ticks"], 601);
  EXPECT_GT(probe["udp"]["samples"].get<int>(), 100);
  EXPECT_GT(probe["udp"]["limits"].get<int>(), 0);
  for (const char* fault : {"wrong_size", "wrong_head", "wrong_value", "strangers", "replayed"})
    EXPECT_EQ(probe["udp"][fault], 0) << fault;
  EXPECT_LT(probe["position_m"][2].get<double>(), rest[2]);
  EXPECT_GT(device.received, 100);
  EXPECT_GT(device.largest_up_n, 0.1);
  EXPECT_LE(device.largest_after_n, largest_force_n * (1 + 1e-12));
}

TEST_F(SimulateUdp, WithoutADeviceTheToolStaysWhereItIs) {
  const auto result = run_souple(words(free_port()));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto probe = result.json()["probes"][0];
  EXPECT_EQ(probe["udp"]["samples"], 0);
  EXPECT_EQ(probe["force_n"], nlohmann::json({0.0, 0.0, 0.0}));
}

TEST_F(SimulateUdp, APortInUseIsRefusedByItsCode) {
  const auto taken = LoopbackSocket::open(0);
  ASSERT_TRUE(taken.ok());
  const auto result = run_souple(words(taken->port()));
  expect_issue(result, 4, "S4203");
}

}  // namespace
}  // namespace souple::test
