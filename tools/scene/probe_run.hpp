// SPDX-License-Identifier: GPL-3.0-or-later
// A probe of a scene while it runs: the device, the channel to the world, the ticks between steps.
#pragma once
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "formats/core/result.hpp"
#include "runtime/haptics/devices/synthetic_hand.hpp"
#include "runtime/haptics/haptic_channel.hpp"
#include "runtime/haptics/passivity_controller.hpp"
#include "runtime/haptics_net/udp_device.hpp"
#include "tools/scene/scene_tools.hpp"

namespace souple {

/// What a report tells of a probe.
struct ProbeReport {
  std::string name;
  ProbeDevice device{};
  ProbePassivity passivity{};
  double rate_hz = 0;
  HapticTelemetry telemetry;
  DeviceSample last_sample;
  Wrench last_wrench;
  double observed_energy_j = 0, dissipated_j = 0;  ///< by the passivity control
  std::uint64_t damped_ticks = 0;
  std::optional<double> hand_received_j;  ///< of a simulated hand
  std::optional<UdpDeviceCounts> udp;
};

/// Ticks on the simulated clock, with the problem of the step that was just done: the same run every
/// time. With a device by UDP ticks keep the wall clock instead.
class ProbeRun {
 public:
  /// Issues: those of HapticChannel, the devices and PassivityController.
  static Result<ProbeRun> create(const SceneProbe& probe, const SceneTool& tool);

  /// The tool to where the hand is: before World::step.
  Status begin_step(World& world) { return channel_.begin_step(world); }
  /// After it: publishes, and ticks until the world's time.
  Status end_step(const World& world);
  ProbeReport report() const;

 private:
  ProbeRun(const SceneProbe& probe, HapticChannel channel)
      : probe_(probe), channel_(std::move(channel)) {}
  void tick();
  void wait_for_tick();

  using Clock = std::chrono::steady_clock;
  SceneProbe probe_;
  HapticChannel channel_;
  std::optional<PassivityController> passivity_;
  std::unique_ptr<HapticDevice> device_;
  const SyntheticHand* hand_ = nullptr;  ///< the device, if it is one
  const UdpDevice* udp_ = nullptr;       ///< likewise
  Clock::time_point start_ = Clock::now();
  std::uint64_t ticks_ = 0;
  DeviceSample sample_;
  Wrench wrench_;
};

}  // namespace souple
