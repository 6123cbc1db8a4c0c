// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "runtime/compliance/range_decoder.hpp"

namespace souple {

/// Writes what RangeDecoder reads.
class RangeEncoder {
 public:
  bool bit(AdaptiveBit& model, bool bit) {
    const std::uint32_t bound = (range_ >> AdaptiveBit::precision) * model.zero_probability();
    if (bit) {
      low_ += bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    model.learn(bit);
    normalise();
    return bit;
  }

  std::uint32_t direct(int count, std::uint32_t bits) {
    range_ >>= count;
    low_ += std::uint64_t{bits} * range_;
    normalise();
    return bits;
  }

  std::vector<std::byte> finish() {
    for (int k = 0; k < 5; ++k) shift_out();
    return std::move(bytes_);
  }

 private:
  void normalise() {
    while (range_ < (std::uint32_t{1} << 24)) {
      range_ <<= 8;
      shift_out();
    }
  }

  // The highest byte of `low_` waits in `pending_` until no later addition can carry into it; a run of
  // bytes 255 behind it would pass a carry on.
  void shift_out() {
    if (low_ < 0xFF000000U || low_ > 0xFFFFFFFFU) {
      const auto carry = std::uint8_t(low_ >> 32);
      if (has_pending_) bytes_.push_back(std::byte(std::uint8_t(pending_ + carry)));
      for (; run_ > 0; --run_) bytes_.push_back(std::byte(std::uint8_t(0xFF + carry)));
      pending_ = std::uint8_t(low_ >> 24);
      has_pending_ = true;
    } else {
      ++run_;
    }
    low_ = (low_ << 8) & 0xFFFFFFFFU;
  }

  std::vector<std::byte> bytes_;
  std::uint64_t low_ = 0;
  std::uint64_t run_ = 0;
  std::uint32_t range_ = 0xFFFFFFFFU;
  std::uint8_t pending_ = 0;
  bool has_pending_ = false;
};

}  // namespace souple
