// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/encoded_bytes.hpp"

#include <zlib.h>

#include <utility>

namespace souple {
namespace {

/// Value of a digit, 64 for the padding, -1 for anything else.
int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return c == '=' ? 64 : -1;
}

/// zlib saves at most a factor of 1032 (zlib's technical details): a larger claim is a lie.
bool is_plausible_size(std::uint64_t inflated, std::uint64_t compressed) {
  return inflated / 1032 <= compressed;
}

}  // namespace

/// Four digits, of which the last two may be padding; blanks between them do not count.
bool EncodedBytes::decode_group() {
  std::uint32_t group = 0;
  int digit_count = 0, padding = 0;
  while (digit_count < 4) {
    if (content_.empty()) return false;
    const char c = content_.front();
    content_.remove_prefix(1);
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    const int value = base64_value(c);
    if (value < 0 || (value == 64 && digit_count < 2) || (value < 64 && padding > 0)) return false;
    padding += value == 64;
    group = group << 6 | static_cast<std::uint32_t>(value & 63);
    ++digit_count;
  }
  for (int k = 0; k < 3 - padding; ++k) decoded_ += static_cast<char>(group >> (16 - 8 * k) & 255u);
  return true;
}

std::optional<std::string> EncodedBytes::take(std::uint64_t count) {
  const std::uint64_t most = is_raw_ ? content_.size() : decoded_.size() + content_.size() / 4 * 3;
  if (count > most) return std::nullopt;
  if (is_raw_) {
    std::string bytes(content_.substr(0, count));
    content_.remove_prefix(count);
    return bytes;
  }
  decoded_.reserve(count + 3);
  while (decoded_.size() < count)
    if (!decode_group()) return std::nullopt;
  std::string bytes = std::move(decoded_);
  decoded_ = bytes.substr(count);
  bytes.resize(count);
  return bytes;
}

std::optional<std::string> inflate_blocks(EncodedBytes& source, const BlockSizes& sizes,
                                          std::uint64_t expected) {
  const std::uint64_t count = sizes.compressed.size();
  const std::uint64_t full_count = sizes.last == 0 || count == 0 ? count : count - 1;
  if (sizes.last > expected || (full_count > 0 && sizes.block > expected / full_count))
    return std::nullopt;
  const std::uint64_t rest = count == 0 ? 0 : sizes.last;
  if (full_count * sizes.block + rest != expected) return std::nullopt;
  std::string inflated;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t size = i < full_count ? sizes.block : sizes.last;
    const auto compressed = source.take(sizes.compressed[i]);
    if (!compressed || !is_plausible_size(size, compressed->size())) return std::nullopt;
    const std::size_t begin = inflated.size();
    inflated.resize(begin + size);
    uLongf got = size;
    const int result = ::uncompress(reinterpret_cast<Bytef*>(inflated.data() + begin), &got,
                                    reinterpret_cast<const Bytef*>(compressed->data()),
                                    static_cast<uLong>(compressed->size()));
    if (result != Z_OK || got != size) return std::nullopt;
  }
  return inflated;
}

}  // namespace souple
