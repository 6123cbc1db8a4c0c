// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes that stand in a file as they are or as base64, and zlib's blocks of them.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace souple {

class EncodedBytes {
 public:
  EncodedBytes(std::string_view content, bool is_raw) : content_(content), is_raw_(is_raw) {}

  /// The next bytes; nothing if there are fewer, or what should be base64 is not. Padding may stand
  /// anywhere, since VTK encodes the sizes before compressed data on their own.
  std::optional<std::string> take(std::uint64_t count);

 private:
  bool decode_group();

  std::string_view content_;
  bool is_raw_;
  std::string decoded_;  ///< bytes of a group of base64 that were not taken yet
};

struct BlockSizes {
  std::uint64_t block = 0;  ///< of every block, inflated
  std::uint64_t last = 0;   ///< of the last block; 0: it is full
  std::vector<std::uint64_t> compressed;
};

/// The inflated blocks, if they are `expected` bytes in all.
std::optional<std::string> inflate_blocks(EncodedBytes& source, const BlockSizes& sizes,
                                          std::uint64_t expected);

}  // namespace souple
