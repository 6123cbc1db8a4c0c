// SPDX-License-Identifier: MIT
// What the benchmarks share: times of repeated runs, a hash of the result, and the line that
// scoreboard.sh reads.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

namespace souple::bench {

/// FNV-1a, 64 bits, over the bytes of plain values: shows whether two runs gave the same result.
class ResultHash {
 public:
  template <class T>
  void add(std::span<const T> values) {
    for (const std::byte byte : std::as_bytes(values)) {
      state_ = (state_ ^ static_cast<std::uint64_t>(byte)) * 1099511628211ULL;
    }
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(std::span<const T>(values));
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 14695981039346656037ULL;
};

/// Wall time of one call, in seconds.
template <class Work>
double seconds_of(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Wall times of `run_count` calls, in seconds, after one that is not counted.
template <class Work>
std::vector<double> repeated_seconds(int run_count, Work&& work) {
  work();
  std::vector<double> seconds;
  for (int run = 0; run < run_count; ++run) seconds.push_back(seconds_of(work));
  return seconds;
}

/// The middle value; of an even count the mean of the middle two. 0 for none.
inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/// One row from repeated measurements, each multiplied by `scale` (1e3 for seconds shown in ms).
inline void print_row(const std::string& name, const std::string& unit, std::vector<double> values,
                      const ResultHash& hash, double scale = 1) {
  if (values.empty()) return;
  for (double& value : values) value *= scale;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  std::printf("row %s value=%.9g unit=%s min=%.9g max=%.9g runs=%zu hash=%016llx\n", name.c_str(),
              median(values), unit.c_str(), *least, *most, values.size(),
              static_cast<unsigned long long>(hash.value()));
}

/// One row of a figure that no repetition changes.
inline void print_row(const std::string& name, const std::string& unit, double value,
                      const ResultHash& hash) {
  std::printf("row %s value=%.9g unit=%s hash=%016llx\n", name.c_str(), value, unit.c_str(),
              static_cast<unsigned long long>(hash.value()));
}

}  // namespace souple::bench
