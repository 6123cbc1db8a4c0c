// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace souple::storage {

/// Takes little-endian numbers from the front of bytes; once it has run past the end it stays failed.
class ByteCursor {
 public:
  explicit ByteCursor(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool ok() const { return ok_; }
  bool at_end() const { return ok_ && bytes_.empty(); }
  std::size_t left() const { return bytes_.size(); }

  std::span<const std::byte> take(std::uint64_t count) {
    if (count > bytes_.size()) ok_ = false;
    if (!ok_) return {};
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  /// `width` of 1 to 8 bytes; 0 once failed.
  std::uint64_t number(std::size_t width) {
    std::uint64_t value = 0;
    const auto taken = take(width);
    if (!taken.empty()) std::memcpy(&value, taken.data(), width);
    return value;
  }
  bool is(std::size_t width, std::uint64_t expected) {
    const std::uint64_t value = number(width);
    return ok_ && value == expected;
  }
  bool signature(std::string_view text) {
    const auto taken = take(text.size());
    return !taken.empty() && std::memcmp(taken.data(), text.data(), text.size()) == 0;
  }

 private:
  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

}  // namespace souple::storage
