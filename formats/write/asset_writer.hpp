// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <filesystem>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct WriteOptions {
  int zstd_level = 3;
};

/// Writes an asset to a temporary file beside `file`, then renames: there is never a half-written
/// asset. Same asset, same bytes. Refuses content that validate_asset_content refuses.
/// Issues: io_cannot_write (folder missing, a directory in the place, disk full), asset_corrupt.
Status write_asset(const Asset& asset, const std::filesystem::path& file, const WriteOptions& = {});

/// The bytes that write_asset would put into the file.
Result<std::vector<std::byte>> write_asset_memory(const Asset& asset, const WriteOptions& = {});

}  // namespace souple
