// SPDX-License-Identifier: MIT
// A device that is another program: packets to the byte, and what is sent by somebody who means ill.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <limits>
#include <random>
#include <thread>

#include "runtime/haptics_net/udp_device.hpp"
#include "tests/support/allocation_count.hpp"

namespace souple {
namespace {

DeviceSample some_sample(double time_s = 1.5) {
  return {time_s, {{0.5, 0.5, -0.5, 0.5}, {0.1, -0.2, 0.3}}, 0.4};
}

UdpDevice device_of(double peer_silence_s = 60) {
  UdpDeviceSettings settings;
  settings.peer_silence_s = peer_silence_s;
  Result<UdpDevice> device = UdpDevice::open(settings);
  EXPECT_TRUE(device.ok()) << (device.ok() ? "" : device.issue().what);
  return std::move(*device);
}

DeviceLink link_to(const UdpDevice& device) {
  Result<DeviceLink> link = DeviceLink::open(device.port());
  EXPECT_TRUE(link.ok());
  return std::move(*link);
}

// Datagrams on the loopback are there at once, but the system owes nobody that.
bool read_soon(UdpDevice& device, DeviceSample& sample) {
  for (int k = 0; k < 200; ++k) {
    if (device.read(sample)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

TEST(DevicePacket, IsLaidOutAsDocumented) {
  const SampleBytes bytes = encode(SamplePacket{0x0102030405060708, 0x1112131415161718, some_sample()});
  const unsigned char head[] = {'S', 'P', 'H', 'D', 1,    0,    1,    0,    8,    7,    6,    5,
                                4,   3,   2,   1,   0x18, 0x17, 0x16, 0x15, 0x14, 0x13, 0x12, 0x11};
  EXPECT_EQ(std::memcmp(bytes.data(), head, sizeof head), 0);
  const auto number_at = [&](std::size_t offset) {
    double value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
  };
  EXPECT_EQ(number_at(24), 1.5);   // time
  EXPECT_EQ(number_at(32), 0.1);   // x
  EXPECT_EQ(number_at(56), 0.5);   // quaternion w
  EXPECT_EQ(number_at(72), -0.5);  // quaternion y
  EXPECT_EQ(number_at(88), 0.4);   // opening
}

TEST(DevicePacket, ComesBackAsItWas) {
  SamplePacket sample;
  ASSERT_EQ(decode(encode(SamplePacket{7, 5, some_sample()}), sample), PacketFault::none);
  EXPECT_EQ(sample.sequence, 7u);
  EXPECT_EQ(sample.answered, 5u);
  EXPECT_EQ(sample.sample.pose.translation, some_sample().pose.translation);
  EXPECT_EQ(sample.sample.pose.rotation, some_sample().pose.rotation);
  WrenchPacket wrench;
  ASSERT_EQ(decode(encode(WrenchPacket{9, 2.5, {{1, 2, 3}, {4, 5, 6}, 7}}), wrench), PacketFault::none);
  EXPECT_EQ(wrench.sequence, 9u);
  EXPECT_EQ(wrench.time_s, 2.5);
  EXPECT_EQ(wrench.wrench.torque_nm, (Point{4, 5, 6}));
  EXPECT_EQ(wrench.wrench.opening_nm, 7);
  DeviceLimits limits;
  limits.force_n = 3.3;
  limits.has_opening = true;
  LimitsPacket got;
  ASSERT_EQ(decode(encode(LimitsPacket{1, limits}), got), PacketFault::none);
  EXPECT_EQ(got.limits.force_n, 3.3);
  EXPECT_EQ(got.limits.torque_nm, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(got.limits.has_opening);
}

TEST(DevicePacket, RefusesEveryCutAndEveryKindOfRubbish) {
  const SampleBytes bytes = encode(SamplePacket{1, 0, some_sample()});
  SamplePacket packet;
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_EQ(decode(std::span(bytes).first(size), packet), PacketFault::size) << size;
  for (const std::size_t at : {0, 3, 4, 7}) {
    SampleBytes wrong = bytes;
    wrong[at] ^= std::byte{0x40};
    EXPECT_EQ(decode(wrong, packet), PacketFault::magic) << at;
  }
  EXPECT_EQ(decode(encode(WrenchPacket{1, 0, {}}), packet), PacketFault::direction);
  EXPECT_EQ(decode(encode(SamplePacket{0, 0, some_sample()}), packet), PacketFault::value);
  std::mt19937_64 random(3);
  for (int k = 0; k < 20000; ++k) {
    SampleBytes noise = bytes;
    for (std::size_t at = 8; at < noise.size(); ++at) noise[at] = std::byte(random() & 0xff);
    if (decode(noise, packet) != PacketFault::none) continue;
    for (const double x : packet.sample.pose.translation) ASSERT_LE(std::abs(x), 1e3);
    ASSERT_TRUE(std::isfinite(packet.sample.time_s));
  }
}

TEST(DevicePacket, RefusesNumbersThatAreNone) {
  const auto fault_of = [](auto&& change) {
    SamplePacket sent{1, 0, some_sample()}, got;
    change(sent.sample);
    return decode(encode(sent), got);
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fault_of([](auto& s) { s.time_s = nan; }), PacketFault::value);
  EXPECT_EQ(fault_of([](auto& s) { s.pose.translation[2] = 1e300; }), PacketFault::value);
  EXPECT_EQ(fault_of([](auto& s) { s.pose.rotation = {0, 0, 0, 0}; }), PacketFault::value);
  EXPECT_EQ(fault_of([](auto& s) { s.pose.rotation[1] = nan; }), PacketFault::value);
  EXPECT_EQ(fault_of([](auto& s) { s.opening_rad = -1e9; }), PacketFault::value);
  LimitsPacket limits{1, {}}, got;
  limits.limits.rate_hz = 0;
  EXPECT_EQ(decode(encode(limits), got), PacketFault::value);
  limits.limits = {};
  limits.limits.force_n = -1;
  EXPECT_EQ(decode(encode(limits), got), PacketFault::value);
}

TEST(UdpDevice, CarriesPosesOneWayAndWrenchesTheOther) {
  UdpDevice device = device_of();
  DeviceLink link = link_to(device);
  DeviceLimits limits;
  limits.rate_hz = 4000;
  limits.force_n = 8;
  ASSERT_TRUE(link.send_limits(limits));
  ASSERT_TRUE(link.send_sample(some_sample(2)));
  DeviceSample sample;
  device.write({{9, 9, 9}, {}, 0});  // nobody has asked yet
  ASSERT_TRUE(read_soon(device, sample));
  EXPECT_EQ(sample.time_s, 2);
  EXPECT_EQ(device.limits().rate_hz, 4000);
  EXPECT_EQ(device.limits().force_n, 8);
  EXPECT_FALSE(device.read(sample));
  device.write({{1, 2, 3}, {0, 0, 1}, -1});
  Wrench wrench;
  for (int k = 0; k < 200 && !link.receive(wrench); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(wrench.force_n, (Point{1, 2, 3}));
  EXPECT_EQ(wrench.opening_nm, -1);
  EXPECT_EQ(link.answered(), link.sequence());
  ASSERT_TRUE(link.send_sample(some_sample(3)));
  ASSERT_TRUE(read_soon(device, sample));
  EXPECT_EQ(device.answered(), 2u);
}

TEST(UdpDevice, TakesTheNewestOfManyAndAllocatesNothing) {
  UdpDevice device = device_of();
  DeviceLink link = link_to(device);
  DeviceSample sample;
  const std::size_t before = test::allocation_count();
  for (int k = 1; k <= 40; ++k) link.send_sample(some_sample(k));
  EXPECT_FALSE(!read_soon(device, sample));
  device.write({});
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(sample.time_s, 40);
  EXPECT_EQ(device.counts().samples, 40u);
  EXPECT_EQ(device.counts().overtaken, 39u);
}

TEST(UdpDevice, DropsAndCountsHostilePackets) {
  UdpDevice device = device_of();
  Result<LoopbackSocket> socket = LoopbackSocket::open(0), stranger = LoopbackSocket::open(0);
  ASSERT_TRUE(socket.ok() && stranger.ok());
  const auto send = [&](std::span<const std::byte> bytes) { socket->send(bytes, device.port()); };
  DeviceSample sample;
  send(encode(SamplePacket{5, 0, some_sample(1)}));
  ASSERT_TRUE(read_soon(device, sample));
  send(encode(SamplePacket{5, 0, some_sample(2)}));
  send(encode(SamplePacket{4, 0, some_sample(3)}));
  const SampleBytes good = encode(SamplePacket{6, 0, some_sample(4)});
  send(std::span(good).first(95));
  const std::array<std::byte, 1200> long_one{};
  send(long_one);
  send({});
  SampleBytes foreign = good;
  foreign[0] = std::byte{0};
  send(foreign);
  DeviceSample bad = some_sample(5);
  bad.pose.translation[0] = std::numeric_limits<double>::infinity();
  send(encode(SamplePacket{7, 0, bad}));
  send(encode(WrenchPacket{8, 0, {}}));
  stranger->send(encode(SamplePacket{99, 0, some_sample(6)}), device.port());
  EXPECT_FALSE(read_soon(device, sample));
  EXPECT_EQ(sample.time_s, 1);
  const UdpDeviceCounts& counts = device.counts();
  EXPECT_EQ(counts.replayed, 2u);
  EXPECT_EQ(counts.wrong_size, 3u);
  EXPECT_EQ(counts.wrong_head, 2u);
  EXPECT_EQ(counts.wrong_value, 1u);
  EXPECT_EQ(counts.strangers, 1u);
  EXPECT_EQ(counts.samples, 1u);
  send(encode(SamplePacket{9, 0, some_sample(7)}));
  ASSERT_TRUE(read_soon(device, sample));
  EXPECT_EQ(sample.time_s, 7);
  EXPECT_EQ(device.counts().lost, 3u);  // 6, 7 and 8
}

TEST(UdpDevice, BelievesADeviceThatWasStartedAgain) {
  UdpDevice device = device_of(0.02);
  DeviceSample sample;
  {
    DeviceLink first = link_to(device);
    for (int k = 0; k < 5; ++k) first.send_sample(some_sample(k));
    ASSERT_TRUE(read_soon(device, sample));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(40));
  DeviceLink second = link_to(device);
  second.send_sample(some_sample(77));
  ASSERT_TRUE(read_soon(device, sample));
  EXPECT_EQ(sample.time_s, 77);
}

TEST(UdpDevice, AFloodDoesNotHoldItUp) {
  UdpDevice device = device_of();
  DeviceLink link = link_to(device);
  for (int k = 0; k < 500; ++k) link.send_sample(some_sample(k));
  DeviceSample sample;
  ASSERT_TRUE(read_soon(device, sample));
  EXPECT_LE(device.counts().samples, 64u);
}

TEST(UdpDevice, ATakenPortIsRefusedWithItsNumber) {
  UdpDevice device = device_of();
  UdpDeviceSettings settings;
  settings.port = device.port();
  const Result<UdpDevice> second = UdpDevice::open(settings);
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.issue().code, IssueCode::device_port_unavailable);
  EXPECT_NE(second.issue().what.find(std::to_string(device.port())), std::string::npos);
}

}  // namespace
}  // namespace souple
