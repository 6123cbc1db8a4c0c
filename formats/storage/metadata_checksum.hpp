// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace souple::storage {

/// The checksum of HDF5's metadata blocks: Jenkins' lookup3 (hashlittle), initial value 0.
std::uint32_t metadata_checksum(std::span<const std::byte> bytes);

}  // namespace souple::storage
