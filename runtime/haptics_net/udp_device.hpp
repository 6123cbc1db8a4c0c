// SPDX-License-Identifier: MIT
#pragma once
#include <chrono>

#include "runtime/haptics_net/device_packet.hpp"
#include "runtime/haptics_net/loopback_socket.hpp"

namespace souple {

struct UdpDeviceSettings {
  std::uint16_t port = 0;  ///< to listen at; 0: a free one
  DeviceLimits limits;     ///< until the device declares its own
  /// After so long without a good packet the device may be another program, or begin to count anew.
  double peer_silence_s = 1;
};

struct UdpDeviceCounts {
  std::uint64_t samples = 0, limits = 0;  ///< taken
  std::uint64_t lost = 0;                 ///< by gaps in the sequence
  std::uint64_t overtaken = 0;            ///< good samples that a newer one was already there for
  std::uint64_t wrong_size = 0, wrong_head = 0, wrong_value = 0;
  std::uint64_t replayed = 0;   ///< sequence not newer than one before
  std::uint64_t strangers = 0;  ///< from another program than the device
  std::uint64_t not_sent = 0;   ///< wrenches that the system did not take
};

/// A device that is another program on this machine, by UDP. Packets that are short, foreign, old or
/// hold no numbers are dropped and counted.
class UdpDevice final : public HapticDevice {
 public:
  /// Issues: device_port_unavailable, world_parameter_invalid.
  static Result<UdpDevice> open(const UdpDeviceSettings& settings);

  std::uint16_t port() const { return socket_.port(); }
  DeviceLimits limits() const override { return limits_; }
  bool read(DeviceSample& sample) override;
  /// Answers the sample that was read last; before the first one nothing is sent.
  void write(const Wrench& wrench) override;

  const UdpDeviceCounts& counts() const { return counts_; }
  bool declared_limits() const { return counts_.limits > 0; }
  /// Of the last sample read.
  std::uint64_t sequence() const { return read_sequence_; }
  std::uint64_t answered() const { return answered_; }

 private:
  UdpDevice(LoopbackSocket socket, const UdpDeviceSettings& settings)
      : socket_(std::move(socket)), settings_(settings), limits_(settings.limits) {}
  using Clock = std::chrono::steady_clock;
  bool take(std::span<const std::byte> bytes, std::uint16_t from, DeviceSample& sample);
  bool is_next(std::uint64_t sequence, std::uint16_t from);
  void count(PacketFault fault);

  LoopbackSocket socket_;
  UdpDeviceSettings settings_;
  DeviceLimits limits_;
  UdpDeviceCounts counts_;
  std::uint16_t peer_ = 0;
  std::uint64_t sequence_ = 0, read_sequence_ = 0, answered_ = 0;
  double read_time_s_ = 0;
  Clock::time_point last_packet_{};
};

/// The other end: what the program around a device's SDK sends and gets. docs/haptic_device.md.
class DeviceLink {
 public:
  /// To souple listening at this port. Issue device_port_unavailable.
  static Result<DeviceLink> open(std::uint16_t souple_port);

  bool send_limits(const DeviceLimits& limits);
  bool send_sample(const DeviceSample& sample);
  /// The newest wrench that came since the last call; false: none, `wrench` is unchanged.
  bool receive(Wrench& wrench);
  /// Of the sample that the newest wrench answers; 0: none came yet.
  std::uint64_t answered() const { return answered_; }
  std::uint64_t sequence() const { return sequence_; }

 private:
  DeviceLink(LoopbackSocket socket, std::uint16_t port) : socket_(std::move(socket)), port_(port) {}
  LoopbackSocket socket_;
  std::uint16_t port_;
  std::uint64_t sequence_ = 0, answered_ = 0;
};

}  // namespace souple
