// SPDX-License-Identifier: MIT
#include "runtime/haptics_net/device_packet.hpp"

#include <bit>
#include <cmath>
#include <concepts>

namespace souple {
namespace {

class Writer {
 public:
  explicit Writer(std::span<std::byte> bytes) : bytes_(bytes) {}
  template <std::unsigned_integral T>
  void put(T value) {
    for (std::size_t k = 0; k < sizeof(T); ++k) bytes_[at_++] = std::byte(value >> (8 * k) & 0xff);
  }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  void put(std::span<const double> values) {
    for (const double value : values) put(value);
  }
  void head(PacketKind kind, std::uint64_t sequence) {
    put(packet_magic);
    put(packet_version);
    put(std::uint16_t(kind));
    put(sequence);
  }

 private:
  std::span<std::byte> bytes_;
  std::size_t at_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes, std::size_t at = 0) : bytes_(bytes), at_(at) {}
  template <class T>
  T take() {
    T value = 0;
    for (std::size_t k = 0; k < sizeof(T); ++k) value = T(value | T(bytes_[at_++]) << (8 * k));
    return value;
  }
  double number() { return std::bit_cast<double>(take<std::uint64_t>()); }
  void numbers(std::span<double> values) {
    for (double& value : values) value = number();
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_;
};

constexpr std::size_t sequence_at = 8;

std::size_t size_of(PacketKind kind) {
  if (kind == PacketKind::sample) return sample_packet_size;
  return kind == PacketKind::wrench ? wrench_packet_size : limits_packet_size;
}

PacketFault expect(std::span<const std::byte> bytes, PacketKind expected) {
  PacketKind kind{};
  if (const PacketFault fault = read_head(bytes, kind); fault != PacketFault::none) return fault;
  return kind == expected ? PacketFault::none : PacketFault::direction;
}

bool within(std::span<const double> values, double largest) {
  for (const double value : values)
    if (!(std::abs(value) <= largest)) return false;
  return true;
}

}  // namespace

SampleBytes encode(const SamplePacket& packet) {
  SampleBytes bytes{};
  Writer out(bytes);
  out.head(PacketKind::sample, packet.sequence);
  out.put(packet.answered);
  out.put(packet.sample.time_s);
  out.put(packet.sample.pose.translation);
  out.put(packet.sample.pose.rotation);
  out.put(packet.sample.opening_rad);
  return bytes;
}

WrenchBytes encode(const WrenchPacket& packet) {
  WrenchBytes bytes{};
  Writer out(bytes);
  out.head(PacketKind::wrench, packet.sequence);
  out.put(packet.time_s);
  out.put(packet.wrench.force_n);
  out.put(packet.wrench.torque_nm);
  out.put(packet.wrench.opening_nm);
  return bytes;
}

LimitsBytes encode(const LimitsPacket& packet) {
  LimitsBytes bytes{};
  Writer out(bytes);
  const DeviceLimits& limits = packet.limits;
  out.head(PacketKind::limits, packet.sequence);
  for (const double value : {limits.rate_hz, limits.force_n, limits.torque_nm, limits.opening_nm,
                             limits.force_slew_n_s, limits.torque_slew_nm_s})
    out.put(value);
  out.put(std::uint32_t(limits.has_opening));
  return bytes;
}

PacketFault read_head(std::span<const std::byte> bytes, PacketKind& kind) {
  if (bytes.size() < sequence_at) return PacketFault::size;
  Reader in(bytes);
  if (in.take<std::uint32_t>() != packet_magic || in.take<std::uint16_t>() != packet_version)
    return PacketFault::magic;
  const std::uint16_t number = in.take<std::uint16_t>();
  if (number < 1 || number > 3) return PacketFault::magic;
  kind = PacketKind(number);
  return bytes.size() == size_of(kind) ? PacketFault::none : PacketFault::size;
}

PacketFault decode(std::span<const std::byte> bytes, SamplePacket& packet) {
  if (const PacketFault fault = expect(bytes, PacketKind::sample); fault != PacketFault::none)
    return fault;
  Reader in(bytes, sequence_at);
  packet.sequence = in.take<std::uint64_t>();
  packet.answered = in.take<std::uint64_t>();
  DeviceSample& sample = packet.sample;
  sample.time_s = in.number();
  in.numbers(sample.pose.translation);
  in.numbers(sample.pose.rotation);
  sample.opening_rad = in.number();
  double length2 = 0;
  for (const double q : sample.pose.rotation) length2 += q * q;
  if (packet.sequence == 0 || !(std::abs(sample.time_s) <= 1e12) ||
      !within(sample.pose.translation, 1e3) || !(std::abs(std::sqrt(length2) - 1) < 0.01) ||
      !(std::abs(sample.opening_rad) <= 2 * M_PI))
    return PacketFault::value;
  for (double& q : sample.pose.rotation) q /= std::sqrt(length2);
  return PacketFault::none;
}

PacketFault decode(std::span<const std::byte> bytes, WrenchPacket& packet) {
  if (const PacketFault fault = expect(bytes, PacketKind::wrench); fault != PacketFault::none)
    return fault;
  Reader in(bytes, sequence_at);
  packet.sequence = in.take<std::uint64_t>();
  packet.time_s = in.number();
  in.numbers(packet.wrench.force_n);
  in.numbers(packet.wrench.torque_nm);
  packet.wrench.opening_nm = in.number();
  constexpr double largest = 1e9;
  const bool sound =
      packet.sequence != 0 && std::isfinite(packet.time_s) && within(packet.wrench.force_n, largest) &&
      within(packet.wrench.torque_nm, largest) && std::abs(packet.wrench.opening_nm) <= largest;
  return sound ? PacketFault::none : PacketFault::value;
}

PacketFault decode(std::span<const std::byte> bytes, LimitsPacket& packet) {
  if (const PacketFault fault = expect(bytes, PacketKind::limits); fault != PacketFault::none)
    return fault;
  Reader in(bytes, sequence_at);
  packet.sequence = in.take<std::uint64_t>();
  DeviceLimits& limits = packet.limits;
  limits.rate_hz = in.number();
  double* const others[] = {&limits.force_n, &limits.torque_nm, &limits.opening_nm,
                            &limits.force_slew_n_s, &limits.torque_slew_nm_s};
  bool sound = packet.sequence != 0 && limits.rate_hz >= 1 && limits.rate_hz <= 1e5;
  for (double* const value : others) {
    *value = in.number();
    sound = sound && *value > 0;
  }
  const std::uint32_t has_opening = in.take<std::uint32_t>();
  limits.has_opening = has_opening == 1;
  return sound && has_opening <= 1 ? PacketFault::none : PacketFault::value;
}

}  // namespace souple
