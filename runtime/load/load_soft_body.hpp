// SPDX-License-Identifier: MIT
// From an asset file to a SoftBodyAsset. Reads files: never call it from a real-time thread.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "formats/core/result.hpp"
#include "formats/read/asset_reader.hpp"

namespace souple {

class SoftBodyAsset;

struct LoadOptions {
  /// Names of the compliance variants to load; empty: all. Others are not read.
  std::vector<std::string> compliances{};
  bool no_compliances = false;  ///< load none, for the exact contact method
  bool visual = false;          ///< load the visual surface too, if the asset has one
};

/// Reads the mesh of the finest level, material, fixed sets and what is chosen, and prepares the body.
/// Coarser levels and what ties the levels to each other are not read.
/// Issues: those of AssetReader; asset_missing_part; mesh_element_invalid; material_out_of_range.
Result<std::shared_ptr<const SoftBodyAsset>> load_soft_body(AssetReader& reader,
                                                            const LoadOptions& options = {});
Result<std::shared_ptr<const SoftBodyAsset>> load_soft_body(const std::filesystem::path& file,
                                                            const LoadOptions& options = {});

}  // namespace souple
