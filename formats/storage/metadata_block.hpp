// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/storage/byte_device.hpp"

namespace souple::storage {

inline constexpr std::size_t checksum_bytes = 4;
inline constexpr std::uint64_t largest_metadata_block = std::uint64_t{16} << 20;

/// A block of `length` bytes of which the last four are its checksum, without these; empty unless the
/// block is there and the checksum fits.
std::vector<std::byte> read_metadata_block(ByteDevice& device, std::uint64_t address,
                                           std::uint64_t length);

}  // namespace souple::storage
