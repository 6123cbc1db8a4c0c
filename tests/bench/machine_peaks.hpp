// SPDX-License-Identifier: GPL-3.0-or-later
// What one core can do at most with the instructions of the baseline, to hold figures against.
#pragma once
#include <immintrin.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <vector>

namespace souple::bench {

/// Time of this thread on its core, s: other programs do not count.
inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// Least thread time of `run_count` calls, s.
template <class Work>
double least_seconds(int run_count, Work&& work) {
  double least = 1e300;
  for (int run = 0; run < run_count; ++run) {
    const double start = thread_seconds();
    work();
    least = std::min(least, thread_seconds() - start);
  }
  return least;
}

/// a = b + s c over arrays of `bytes` in all: bytes read and written per second.
inline double triad_bytes_per_s(std::size_t bytes) {
  const std::size_t n = bytes / (3 * sizeof(float));
  std::vector<float> a(n, 0), b(n, 1), c(n, 2);
  const int sweeps = int(std::max<std::size_t>(1, (std::size_t{64} << 20) / bytes));
  const double seconds = least_seconds(9, [&] {
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      const float s = 0.5F + a[0];
      for (std::size_t k = 0; k < n; ++k) a[k] = b[k] + s * c[k];
    }
  });
  return double(3 * n * sizeof(float)) * sweeps / seconds;
}

/// Independent chains of eight-wide fused multiply-adds: floating-point operations per second.
inline double fma_flops_per_s() {
  constexpr int count = 2'000'000, chains = 12;
  alignas(32) static std::array<float, 8 * chains> keep;
  const double seconds = least_seconds(7, [] {
    __m256 sum[chains];
    for (int k = 0; k < chains; ++k) sum[k] = _mm256_set1_ps(float(k));
    const __m256 x = _mm256_set1_ps(0.999F), y = _mm256_set1_ps(1e-3F);
    for (int step = 0; step < count; ++step)
      for (int k = 0; k < chains; ++k) sum[k] = _mm256_fmadd_ps(sum[k], x, y);
    for (int k = 0; k < chains; ++k) _mm256_store_ps(&keep[8 * std::size_t(k)], sum[k]);
  });
  return 16.0 * chains * count / seconds;
}

}  // namespace souple::bench
