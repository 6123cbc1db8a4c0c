// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "formats/core/result.hpp"
#include "formats/storage/byte_device.hpp"

namespace souple::storage {

/// What HDF5 itself does not insist on before it starts to parse: the signature at offset 0, a
/// checksummed superblock (version 2 or 3), no base offset, no extension, a length that is that of the
/// file to the byte, and a sound root group. Issues: asset_not_an_asset, asset_corrupt.
Status check_superblock(ByteDevice& device, const std::string& where);

}  // namespace souple::storage
