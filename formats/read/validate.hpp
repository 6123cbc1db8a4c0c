// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct ValidationReport {
  std::vector<Issue> issues;         ///< at most the cap, in order of discovery
  std::size_t suppressed_count = 0;  ///< issues past the cap
  bool valid() const;                ///< no issue of severity error
};

struct ValidationOptions {
  std::size_t issue_cap = 100;
};

/// Reads everything, checks structure, ranges, orientation, cross references, checksums and the hash of
/// the logical content. Never throws, never crashes on hostile bytes.
ValidationReport validate_asset_file(const std::filesystem::path& file, const ValidationOptions& = {});
ValidationReport validate_asset_memory(std::span<const std::byte> bytes, const ValidationOptions& = {});

/// The checks of the logical content alone (also run by the writer before it writes).
ValidationReport validate_asset_content(const Asset& asset, const ValidationOptions& = {});

}  // namespace souple
