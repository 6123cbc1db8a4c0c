// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/probe_run.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

namespace souple {
namespace {

// How long a run waits for the other program before it goes on without.
constexpr std::chrono::milliseconds longest_wait{2000}, wait_step{1};

Result<std::unique_ptr<SyntheticHand>> make_hand(const SceneProbe& probe, const SceneTool& tool) {
  SyntheticHandSettings settings;
  settings.model = hand_of_grip(probe.grip);
  settings.limits = probe.haptics.limits;
  settings.resolution_m = probe.resolution_m;
  settings.turn_resolution_rad = probe.turn_resolution_rad;
  settings.opening_resolution_rad = probe.opening_resolution_rad;
  settings.delay_samples = probe.delay_ticks;
  auto hand = SyntheticHand::create(*tool.path, settings);
  if (!hand) return hand.issue();
  return std::make_unique<SyntheticHand>(std::move(*hand));
}

Result<std::unique_ptr<UdpDevice>> open_port(const SceneProbe& probe) {
  UdpDeviceSettings settings;
  settings.port = probe.port;
  settings.limits = probe.haptics.limits;
  auto opened = UdpDevice::open(settings);
  if (!opened) return opened.issue();
  auto device = std::make_unique<UdpDevice>(std::move(*opened));
  DeviceSample sample;
  for (auto waited = wait_step; waited < longest_wait && !device->read(sample); waited += wait_step)
    std::this_thread::sleep_for(wait_step);
  return device;
}

/// What both the scene and the device allow, at the scene's rate.
DeviceLimits narrower(const DeviceLimits& scene, const DeviceLimits& device) {
  DeviceLimits both = scene;
  for (double DeviceLimits::*limit :
       {&DeviceLimits::force_n, &DeviceLimits::torque_nm, &DeviceLimits::opening_nm,
        &DeviceLimits::force_slew_n_s, &DeviceLimits::torque_slew_nm_s})
    both.*limit = std::min(scene.*limit, device.*limit);
  return both;
}

Result<std::optional<PassivityController>> make_passivity(ProbePassivity passivity) {
  if (passivity == ProbePassivity::off) return std::optional<PassivityController>();
  PassivitySettings settings;
  settings.scope = passivity == ProbePassivity::total_power ? PassivityScope::total_power
                                                            : PassivityScope::each_freedom;
  auto controller = PassivityController::create(settings);
  if (!controller) return controller.issue();
  return std::optional<PassivityController>(std::move(*controller));
}

template <class Made>
Status keep(Result<Made> made, std::unique_ptr<HapticDevice>& device) {
  if (!made) return made.issue();
  device = std::move(*made);
  return {};
}

Status make_device(const SceneProbe& probe, const SceneTool& tool,
                   std::unique_ptr<HapticDevice>& device) {
  if (probe.device == ProbeDevice::hand) return keep(make_hand(probe, tool), device);
  if (probe.device == ProbeDevice::udp) return keep(open_port(probe), device);
  auto path = RecordedPathDevice::create(*tool.path, probe.haptics.limits);
  if (!path) return path.issue();
  device = std::make_unique<RecordedPathDevice>(std::move(*path));
  return {};
}

}  // namespace

Result<ProbeRun> ProbeRun::create(const SceneProbe& probe, const SceneTool& tool) {
  std::unique_ptr<HapticDevice> device;
  if (Status status = make_device(probe, tool, device); !status) return status.issue();
  auto passivity = make_passivity(probe.passivity);
  if (!passivity) return passivity.issue();
  HapticSettings settings = probe.haptics;
  settings.limits = narrower(settings.limits, device->limits());
  auto channel = HapticChannel::create(tool.tool, settings);
  if (!channel) return channel.issue();
  ProbeRun run(probe, std::move(*channel));
  run.hand_ = dynamic_cast<const SyntheticHand*>(device.get());
  run.udp_ = dynamic_cast<const UdpDevice*>(device.get());
  run.device_ = std::move(device);
  run.passivity_ = std::move(*passivity);
  run.start_ = Clock::now();
  run.tick();  // the first step begins where the hand is
  return run;
}

void ProbeRun::wait_for_tick() {
  const std::chrono::duration<double> since_start(double(ticks_) / probe_.haptics.limits.rate_hz);
  std::this_thread::sleep_until(start_ + std::chrono::duration_cast<Clock::duration>(since_start));
}

void ProbeRun::tick() {
  if (udp_ != nullptr) wait_for_tick();
  const bool is_new = device_->read(sample_);
  // A program may declare them at any time, or anew.
  if (udp_ != nullptr) channel_.set_limits(narrower(probe_.haptics.limits, device_->limits()));
  wrench_ = is_new ? channel_.tick(sample_) : channel_.tick();
  if (passivity_ && is_new) wrench_ = passivity_->control(sample_, wrench_);
  device_->write(wrench_);
  ++ticks_;
}

Status ProbeRun::end_step(const World& world) {
  if (Status status = channel_.publish(world); !status) return status;
  const auto due = std::uint64_t(std::floor(world.time_s() * probe_.haptics.limits.rate_hz + 1e-6));
  while (ticks_ <= due) tick();
  return {};
}

ProbeReport ProbeRun::report() const {
  ProbeReport report;
  report.name = probe_.name;
  report.device = probe_.device;
  report.passivity = probe_.passivity;
  report.rate_hz = probe_.haptics.limits.rate_hz;
  report.telemetry = channel_.telemetry();
  report.last_sample = sample_;
  report.last_wrench = wrench_;
  if (passivity_) {
    report.observed_energy_j = passivity_->energy_j();
    report.dissipated_j = passivity_->dissipated_j();
    report.damped_ticks = passivity_->damped_ticks();
  }
  if (hand_ != nullptr) report.hand_received_j = hand_->received_j();
  if (udp_ != nullptr) report.udp = udp_->counts();
  return report;
}

}  // namespace souple
