// SPDX-License-Identifier: MIT
#include "runtime/haptics/telemetry.hpp"

#include <cmath>
#include <limits>

namespace souple {

double LogHistogram::upper_bound(std::size_t bin) const {
  if (bin + 1 >= bin_count) return std::numeric_limits<double>::infinity();
  return lowest * std::pow(ratio, double(bin));
}

std::uint64_t LogHistogram::total() const {
  std::uint64_t sum = 0;
  for (const std::uint64_t c : count) sum += c;
  return sum;
}

double LogHistogram::quantile(double share) const {
  const std::uint64_t all = total();
  if (all == 0) return 0;
  const double wanted = share * double(all);
  std::uint64_t sum = 0;
  for (std::size_t bin = 0; bin < bin_count; ++bin) {
    sum += count[bin];
    if (count[bin] > 0 && double(sum) >= wanted) return upper_bound(bin);
  }
  return upper_bound(bin_count - 1);
}

}  // namespace souple
