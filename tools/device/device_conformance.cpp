// SPDX-License-Identifier: GPL-3.0-or-later
// souple_device_conformance [--port N] [--seconds S] [--json]
// Plays souple's side of a device by UDP, and judges what the program at the other end does.
// Exit code 0: it conforms; 7: it does not; 1: usage; as the code says: the port cannot be had.
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "runtime/haptics/devices/device_check.hpp"
#include "runtime/haptics_net/udp_device.hpp"
#include "tools/exchange/numbers.hpp"

namespace souple {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* usage =
    "souple_device_conformance [--port N] [--seconds S] [--json]\n"
    "  --port N      of 127.0.0.1, to which the device sends (47100)\n"
    "  --seconds S   how long it is watched, 1 to 3600 (10)\n"
    "  --json        the verdicts as JSON\n"
    "Start it first, then the program around the device. Exit code 0: the device conforms; 7: not.\n";

constexpr int exit_usage = 1, exit_not_conforming = 7;

struct Options {
  std::int64_t port = 47100;
  double seconds = 10;
  bool json = false;
};

std::optional<Options> parse(int count, char** words) {
  Options options;
  for (int k = 1; k < count; ++k) {
    const std::string_view word = words[k];
    if (word == "--json") {
      options.json = true;
      continue;
    }
    if (++k == count) return std::nullopt;
    if (word == "--port") {
      const auto port = parse_integer(words[k]);
      if (!port || *port < 1 || *port > 65535) return std::nullopt;
      options.port = *port;
    } else if (word == "--seconds") {
      const auto seconds = parse_number(words[k]);
      if (!seconds || !(*seconds >= 1 && *seconds <= 3600)) return std::nullopt;
      options.seconds = *seconds;
    } else {
      return std::nullopt;
    }
  }
  return options;
}

/// A force that can be felt and does no harm: 5 % of what the device declares, at most 0.2 N, along z
/// and back twice a second.
Wrench gentle_wrench(double time_s, const DeviceLimits& limits) {
  const double size = std::min(0.2, 0.05 * limits.force_n);
  return {{0, 0, size * std::sin(4 * M_PI * time_s)}, {}, 0};
}

class Watch {
 public:
  explicit Watch(UdpDevice& device) : device_(device) {}

  /// Until so long after the first sample; false: none came in ten seconds.
  bool run(double seconds) {
    const auto start = Clock::now();
    DeviceSample sample;
    while (true) {
      const double now = since(start);
      if (!check_ && now > longest_wait_s) return false;
      if (check_ && now - begin_s_ > seconds) return true;
      if (!device_.read(sample)) {
        std::this_thread::sleep_for(std::chrono::microseconds(20));
        continue;
      }
      if (!check_) {
        check_.emplace(device_.limits());
        begin_s_ = now;
      }
      meet(now, sample);
    }
  }

  const std::optional<DeviceCheck>& check() const { return check_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr double longest_wait_s = 10;
  static double since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  void meet(double now, const DeviceSample& sample) {
    check_->saw_sample(now, sample);
    const std::uint64_t answered = device_.answered();
    if (answered > last_answered_ && sent_[answered % sent_.size()].sequence == answered)
      check_->saw_answer(now - sent_[answered % sent_.size()].time_s);
    last_answered_ = std::max(last_answered_, answered);
    const Wrench wrench = gentle_wrench(now, device_.limits());
    check_->saw_wrench(wrench);
    device_.write(wrench);
    sent_[device_.sequence() % sent_.size()] = {device_.sequence(), now};
  }

  struct Sent {
    std::uint64_t sequence = 0;
    double time_s = 0;
  };
  UdpDevice& device_;
  std::optional<DeviceCheck> check_;
  double begin_s_ = 0;
  std::uint64_t last_answered_ = 0;
  std::array<Sent, 1024> sent_{};
};

std::vector<DeviceVerdict> judge(const Watch& watch, const UdpDevice& device) {
  std::vector<DeviceVerdict> verdicts;
  if (watch.check()) verdicts = watch.check()->judge();
  const auto none = [&](std::string_view check, std::uint64_t count) {
    verdicts.push_back({check, count == 0, double(count), 0, ""});
  };
  const UdpDeviceCounts& c = device.counts();
  verdicts.push_back({"declares_limits", c.limits > 0, double(c.limits), 1, ""});
  verdicts.push_back(
      {"tells_what_it_answers", device.answered() > 0, double(device.answered()), 1, ""});
  none("wrong_size", c.wrong_size);
  none("wrong_head", c.wrong_head);
  none("wrong_value", c.wrong_value);
  none("replayed", c.replayed);
  none("strangers", c.strangers);
  const double sent = double(c.samples + c.lost);
  const double lost = sent > 0 ? double(c.lost) / sent : 1;
  verdicts.push_back({"lost_share", lost <= 1e-3, lost, 1e-3, ""});
  return verdicts;
}

void print(const std::vector<DeviceVerdict>& verdicts, bool conforms, bool as_json) {
  if (as_json) {
    Json list = Json::array();
    for (const DeviceVerdict& v : verdicts)
      list.push_back({{"check", v.check},
                      {"passed", v.passed},
                      {"value", v.value},
                      {"bound", v.bound},
                      {"unit", v.unit}});
    const Json document = {{"schema", "souple.device-conformance"},
                           {"schema_version", 1},
                           {"conforms", conforms},
                           {"verdicts", list}};
    std::printf("%s\n", document.dump(2).c_str());
    return;
  }
  for (const DeviceVerdict& v : verdicts)
    std::printf("%s  %.*s %s (bound %s) %.*s\n", v.passed ? "ok    " : "FAILED", int(v.check.size()),
                v.check.data(), rounded_text(v.value).c_str(), rounded_text(v.bound).c_str(),
                int(v.unit.size()), v.unit.data());
  std::printf("%s\n", conforms ? "the device conforms" : "the device does not conform");
}

int run(int count, char** words) {
  const auto options = parse(count, words);
  if (!options) {
    std::fputs(usage, stderr);
    return exit_usage;
  }
  UdpDeviceSettings settings;
  settings.port = static_cast<std::uint16_t>(options->port);
  auto device = UdpDevice::open(settings);
  if (!device) {
    std::fprintf(stderr, "%s\n", format_issue(device.issue()).c_str());
    return exit_code(device.issue().code);
  }
  Watch watch(*device);
  const bool met = watch.run(options->seconds);
  if (!met) std::fputs("no sample came in ten seconds\n", stderr);
  const std::vector<DeviceVerdict> verdicts = judge(watch, *device);
  bool conforms = met;
  for (const DeviceVerdict& v : verdicts) conforms = conforms && v.passed;
  print(verdicts, conforms, options->json);
  return conforms ? 0 : exit_not_conforming;
}

}  // namespace
}  // namespace souple

int main(int count, char** words) { return souple::run(count, words); }
