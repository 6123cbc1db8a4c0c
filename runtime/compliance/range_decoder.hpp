// SPDX-License-Identifier: MIT
// Adaptive binary range coding (Martin 1979; the binary form of LZMA): integers only, so that every
// machine reads the same values. The encoder is in tools/compliance/range_encoder.hpp.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace souple {

/// The probability that a bit is 0, learned from the bits so far: fast at first, then over about the
/// last 60.
class AdaptiveBit {
 public:
  static constexpr int precision = 15;

  /// In units of 2^-precision, never 0 or 1.
  std::uint32_t zero_probability() const { return zero_; }
  void learn(bool bit) {
    const int target = bit ? smallest : (1 << precision) - smallest;
    zero_ = static_cast<std::uint16_t>(zero_ + (target - zero_) * rates[seen_] / (1 << 16));
    if (seen_ + 1 < rate_count) ++seen_;
  }

 private:
  static constexpr int smallest = 16, rate_count = 62;
  // 1 / (n + 1.6) after n bits, in units of 2^-16.
  static constexpr std::array<std::int32_t, rate_count> rates = [] {
    std::array<std::int32_t, rate_count> table{};
    for (int n = 0; n < rate_count; ++n) table[std::size_t(n)] = 655360 / (10 * n + 16);
    return table;
  }();

  std::uint16_t zero_ = 1 << (precision - 1);
  std::uint8_t seen_ = 0;
};

/// Reads bits back. Past the end of the bytes it reads zeros: any bytes decode to something.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::byte> bytes) : bytes_(bytes) {
    for (int k = 0; k < 4; ++k) take_byte();
  }

  /// `bit` is what an encoder would write; ignored.
  bool bit(AdaptiveBit& model, bool /*bit*/ = false) {
    const std::uint32_t bound = (range_ >> AdaptiveBit::precision) * model.zero_probability();
    const bool one = code_ >= bound;
    if (one) {
      code_ -= bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    model.learn(one);
    normalise();
    return one;
  }

  /// `count` <= 16 bits of equal probability.
  std::uint32_t direct(int count, std::uint32_t /*bits*/ = 0) {
    range_ >>= count;
    const std::uint32_t bits = std::min(code_ / range_, (std::uint32_t{1} << count) - 1);
    code_ -= bits * range_;
    normalise();
    return bits;
  }

 private:
  void normalise() {
    while (range_ < (std::uint32_t{1} << 24)) {
      range_ <<= 8;
      take_byte();
    }
  }
  void take_byte() {
    code_ = (code_ << 8) | (next_ < bytes_.size() ? std::uint32_t(bytes_[next_]) : 0U);
    ++next_;
  }

  std::span<const std::byte> bytes_;
  std::size_t next_ = 0;
  std::uint32_t range_ = 0xFFFFFFFFU, code_ = 0;
};

}  // namespace souple
