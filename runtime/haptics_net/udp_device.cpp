// SPDX-License-Identifier: MIT
#include "runtime/haptics_net/udp_device.hpp"

#include <array>

namespace souple {
namespace {

// One call looks at no more than this, however fast somebody sends.
constexpr int packets_per_call = 64;

}  // namespace

Result<UdpDevice> UdpDevice::open(const UdpDeviceSettings& settings) {
  if (!(settings.peer_silence_s > 0) ||
      !(settings.limits.rate_hz >= 1 && settings.limits.rate_hz <= 1e5))
    return make_issue(IssueCode::world_parameter_invalid,
                      "a device by UDP needs a rate within [1, 1e5] Hz and a silence above 0 s");
  Result<LoopbackSocket> socket = LoopbackSocket::open(settings.port);
  if (!socket) return socket.issue();
  return UdpDevice(std::move(*socket), settings);
}

void UdpDevice::count(PacketFault fault) {
  if (fault == PacketFault::size) ++counts_.wrong_size;
  if (fault == PacketFault::magic || fault == PacketFault::direction) ++counts_.wrong_head;
  if (fault == PacketFault::value) ++counts_.wrong_value;
}

bool UdpDevice::is_next(std::uint64_t sequence, std::uint16_t from) {
  const Clock::time_point now = Clock::now();
  const bool silent =
      std::chrono::duration<double>(now - last_packet_).count() > settings_.peer_silence_s;
  if (peer_ == 0 || silent) {
    peer_ = from;
    sequence_ = 0;
  }
  if (from != peer_) {
    ++counts_.strangers;
    return false;
  }
  if (sequence <= sequence_) {
    ++counts_.replayed;
    return false;
  }
  if (sequence_ != 0) counts_.lost += sequence - sequence_ - 1;
  sequence_ = sequence;
  last_packet_ = now;
  return true;
}

bool UdpDevice::take(std::span<const std::byte> bytes, std::uint16_t from, DeviceSample& sample) {
  PacketKind kind{};
  if (const PacketFault fault = read_head(bytes, kind); fault != PacketFault::none) {
    count(fault);
    return false;
  }
  if (kind == PacketKind::limits) {
    LimitsPacket packet;
    const PacketFault fault = decode(bytes, packet);
    count(fault);
    if (fault != PacketFault::none || !is_next(packet.sequence, from)) return false;
    limits_ = packet.limits;
    ++counts_.limits;
    return false;
  }
  SamplePacket packet;
  const PacketFault fault = decode(bytes, packet);
  count(fault);
  if (fault != PacketFault::none || !is_next(packet.sequence, from)) return false;
  sample = packet.sample;
  read_sequence_ = packet.sequence;
  answered_ = packet.answered;
  read_time_s_ = packet.sample.time_s;
  ++counts_.samples;
  return true;
}

bool UdpDevice::read(DeviceSample& sample) {
  std::array<std::byte, largest_packet_size> buffer;
  bool any = false;
  for (int k = 0; k < packets_per_call; ++k) {
    const auto datagram = socket_.receive(buffer);
    if (!datagram) break;
    if (datagram->size > buffer.size()) {
      ++counts_.wrong_size;
      continue;
    }
    if (!take(std::span(buffer).first(datagram->size), datagram->from, sample)) continue;
    if (any) ++counts_.overtaken;
    any = true;
  }
  return any;
}

void UdpDevice::write(const Wrench& wrench) {
  if (peer_ == 0 || read_sequence_ == 0) return;
  if (!socket_.send(encode(WrenchPacket{read_sequence_, read_time_s_, wrench}), peer_))
    ++counts_.not_sent;
}

Result<DeviceLink> DeviceLink::open(std::uint16_t souple_port) {
  if (souple_port == 0)
    return make_issue(IssueCode::device_port_unavailable, "port 0 is nobody's to listen at");
  Result<LoopbackSocket> socket = LoopbackSocket::open(0);
  if (!socket) return socket.issue();
  return DeviceLink(std::move(*socket), souple_port);
}

bool DeviceLink::send_limits(const DeviceLimits& limits) {
  return socket_.send(encode(LimitsPacket{++sequence_, limits}), port_);
}

bool DeviceLink::send_sample(const DeviceSample& sample) {
  return socket_.send(encode(SamplePacket{++sequence_, answered_, sample}), port_);
}

bool DeviceLink::receive(Wrench& wrench) {
  std::array<std::byte, largest_packet_size> buffer;
  bool any = false;
  for (int k = 0; k < packets_per_call; ++k) {
    const auto datagram = socket_.receive(buffer);
    if (!datagram) break;
    WrenchPacket packet;
    if (datagram->from != port_ || datagram->size > buffer.size() ||
        decode(std::span(buffer).first(datagram->size), packet) != PacketFault::none ||
        packet.sequence < answered_ || packet.sequence > sequence_)
      continue;
    answered_ = packet.sequence;
    wrench = packet.wrench;
    any = true;
  }
  return any;
}

}  // namespace souple
