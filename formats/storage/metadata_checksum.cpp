// SPDX-License-Identifier: MIT
// lookup3.c, Bob Jenkins, May 2006, public domain.
#include "formats/storage/metadata_checksum.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace souple::storage {
namespace {

struct HashState {
  std::uint32_t a, b, c;

  // clang-format off
  void mix() {
    a -= c; a ^= std::rotl(c, 4); c += b;
    b -= a; b ^= std::rotl(a, 6); a += c;
    c -= b; c ^= std::rotl(b, 8); b += a;
    a -= c; a ^= std::rotl(c, 16); c += b;
    b -= a; b ^= std::rotl(a, 19); a += c;
    c -= b; c ^= std::rotl(b, 4); b += a;
  }
  void finish() {
    c ^= b; c -= std::rotl(b, 14);
    a ^= c; a -= std::rotl(c, 11);
    b ^= a; b -= std::rotl(a, 25);
    c ^= b; c -= std::rotl(b, 16);
    a ^= c; a -= std::rotl(c, 4);
    b ^= a; b -= std::rotl(a, 14);
    c ^= b; c -= std::rotl(b, 24);
  }
  // clang-format on
};

/// Four bytes, those past the end taken as zero.
std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t word = 0;
  if (offset < bytes.size())
    std::memcpy(&word, bytes.data() + offset, std::min<std::size_t>(4, bytes.size() - offset));
  return word;
}

}  // namespace

std::uint32_t metadata_checksum(std::span<const std::byte> bytes) {
  const auto start = 0xDEADBEEFu + static_cast<std::uint32_t>(bytes.size());
  HashState state{start, start, start};
  if (bytes.empty()) return state.c;
  for (; bytes.size() > 12; bytes = bytes.subspan(12)) {
    state.a += word_at(bytes, 0);
    state.b += word_at(bytes, 4);
    state.c += word_at(bytes, 8);
    state.mix();
  }
  state.a += word_at(bytes, 0);
  state.b += word_at(bytes, 4);
  state.c += word_at(bytes, 8);
  state.finish();
  return state.c;
}

}  // namespace souple::storage
