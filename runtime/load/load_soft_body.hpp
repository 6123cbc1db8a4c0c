// SPDX-License-Identifier: MIT
// From an asset file to a SoftBodyAsset. Reads files: never call it from a real-time thread.
#pragma once
#include <filesystem>
#include <functional>
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
  bool multigrid = false;       ///< load what multigrid solvers need of the levels, if the asset has it
  /// Of hierarchical compliances, read the index alone; a thread of each fetches the records of the
  /// nodes that come into contact. Until they are there, `ready` of the compliance is false and asks
  /// for them; call it with the nodes of a place where contact is to be expected. Dense compliances are
  /// loaded.
  bool streaming = false;
  /// Of memory for tables of blocks, so that contacts need not evaluate them: 10 n^2 bytes for a
  /// compliance of n nodes, filled while loading (0.4 s at 3400 nodes). The compliances get
  /// them in the order of the asset as far as this goes; what streams does not. 0: none.
  std::size_t table_bytes = std::size_t{128} << 20;
  /// Called once per compliance, by its fetching thread, if reading fails later. May be empty.
  std::function<void(const Issue&)> streaming_failed{};
};

/// Reads the mesh of the finest level, material, fixed sets and what is chosen, and prepares the body.
/// Coarser levels and what ties the levels to each other are not read. The asset keeps the file open if
/// it streams.
/// Issues: those of AssetReader; asset_missing_part; mesh_element_invalid; material_out_of_range.
Result<std::shared_ptr<const SoftBodyAsset>> load_soft_body(const std::filesystem::path& file,
                                                            const LoadOptions& options = {});
/// The same from an open asset, which is taken over; one in memory has to live as long as the body if
/// it streams.
Result<std::shared_ptr<const SoftBodyAsset>> load_soft_body(AssetReader&& reader,
                                                            const LoadOptions& options = {});
/// The same from an asset that somebody else keeps open. It cannot stream: unsupported_feature.
Result<std::shared_ptr<const SoftBodyAsset>> load_soft_body(AssetReader& reader,
                                                            const LoadOptions& options = {});

}  // namespace souple
