// SPDX-License-Identifier: MIT
// What a device that runs as another program and souple send each other: little-endian packets of fixed
// size, one to a datagram. docs/haptic_device.md is the reference.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "runtime/haptics/device.hpp"

namespace souple {

inline constexpr std::uint32_t packet_magic = 0x44485053;  ///< the bytes "SPHD"
inline constexpr std::uint16_t packet_version = 1;

enum class PacketKind : std::uint16_t { sample = 1, wrench = 2, limits = 3 };

/// From the device. Sequences ascend; the first is 1.
struct SamplePacket {
  std::uint64_t sequence = 0;
  std::uint64_t answered = 0;  ///< sequence of the newest wrench that the device plays; 0: none yet
  DeviceSample sample;
};

/// To the device.
struct WrenchPacket {
  std::uint64_t sequence = 0;  ///< of the sample that it answers
  double time_s = 0;           ///< of that sample
  Wrench wrench;
};

/// From the device, before its first sample, and as often as it likes.
struct LimitsPacket {
  std::uint64_t sequence = 0;  ///< of the same count as the samples'
  DeviceLimits limits;
};

inline constexpr std::size_t sample_packet_size = 96, wrench_packet_size = 80, limits_packet_size = 72;
inline constexpr std::size_t largest_packet_size = 96;

using SampleBytes = std::array<std::byte, sample_packet_size>;
using WrenchBytes = std::array<std::byte, wrench_packet_size>;
using LimitsBytes = std::array<std::byte, limits_packet_size>;

SampleBytes encode(const SamplePacket& packet);
WrenchBytes encode(const WrenchPacket& packet);
LimitsBytes encode(const LimitsPacket& packet);

enum class PacketFault : std::uint8_t {
  none,
  size,       ///< not the size of its kind
  magic,      ///< not one of ours, or another version, or an unknown kind
  value,      ///< a number that is none or is out of range
  direction,  ///< a kind that the other side sends
};

/// Kind of a packet with the right head and size.
PacketFault read_head(std::span<const std::byte> bytes, PacketKind& kind);
/// Finite, within a kilometre, the quaternion of about unit length (normalised here).
PacketFault decode(std::span<const std::byte> bytes, SamplePacket& packet);
PacketFault decode(std::span<const std::byte> bytes, WrenchPacket& packet);
/// The rate within [1, 100000] Hz, all else above zero; infinite: unlimited.
PacketFault decode(std::span<const std::byte> bytes, LimitsPacket& packet);

}  // namespace souple
