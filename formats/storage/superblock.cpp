// SPDX-License-Identifier: MIT
// Offsets: "HDF5 File Format Specification Version 3.0", II.A, superblock versions 2 and 3.
#include "formats/storage/superblock.hpp"

#include <array>
#include <bit>
#include <cstring>

#include "formats/storage/header_messages.hpp"
#include "formats/storage/metadata_block.hpp"
#include "formats/storage/object_header.hpp"

namespace souple::storage {
namespace {

static_assert(std::endian::native == std::endian::little, "bulk data are little-endian as they stand");

constexpr std::size_t superblock_bytes = 48;
constexpr std::array<unsigned char, 8> signature{0x89, 'H', 'D', 'F', '\r', '\n', 0x1A, '\n'};

std::uint64_t word_at(const std::array<std::byte, superblock_bytes>& bytes, std::size_t offset) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

}  // namespace

Status check_superblock(ByteDevice& device, const std::string& where) {
  std::array<std::byte, superblock_bytes> block{};
  if (!device.read(0, block) || std::memcmp(block.data(), signature.data(), signature.size()) != 0)
    return make_issue(IssueCode::asset_not_an_asset, "no HDF5 signature", where);
  const auto byte = [&](std::size_t i) { return std::to_integer<unsigned>(block[i]); };
  if (byte(8) != 2 && byte(8) != 3)
    return make_issue(IssueCode::asset_not_an_asset,
                      "HDF5 superblock version " + std::to_string(byte(8)) + ", not 2 or 3", where);
  if (byte(9) != 8 || byte(10) != 8 || word_at(block, 12) != 0 ||
      word_at(block, 20) != undefined_address)
    return make_issue(IssueCode::asset_corrupt, "unexpected HDF5 superblock", where);
  const std::uint64_t end = word_at(block, 28);
  if (end != device.size())
    return make_issue(IssueCode::asset_corrupt,
                      "the file has " + std::to_string(device.size()) + " bytes, its superblock says " +
                          std::to_string(end),
                      where);
  if (read_metadata_block(device, 0, superblock_bytes).empty())
    return make_issue(IssueCode::asset_corrupt, "the checksum of the superblock is wrong", where);
  if (!is_sound_object(device, word_at(block, 36), ObjectKind::group))
    return make_issue(IssueCode::asset_corrupt, "the root group is damaged", where);
  return {};
}

}  // namespace souple::storage
