// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <filesystem>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct WriteOptions {
  int zstd_level = 3;  ///< 1 to 19; above 3 dense compliances shrink little and take much longer
};

/// Writes an asset to a temporary file beside `file`, then renames: there is never a half-written
/// asset. Same asset, same bytes. Refuses content that validate_asset_content refuses.
/// Named parts are stored in ascending order, whatever their order in `asset`.
/// Issues: io_cannot_write (folder missing, a directory or device in the place, disk full),
/// io_out_of_memory, usage_bad_value (zstd level), or the first that validate_asset_content finds.
Status write_asset(const Asset& asset, const std::filesystem::path& file, const WriteOptions& = {});

/// The bytes that write_asset would put into the file.
Result<std::vector<std::byte>> write_asset_memory(const Asset& asset, const WriteOptions& = {});

}  // namespace souple
