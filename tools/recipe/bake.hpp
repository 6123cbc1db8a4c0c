// SPDX-License-Identifier: GPL-3.0-or-later
// The pipeline: file -> mesh of the body -> material and fixed sets -> compliances -> asset.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "formats/read/asset_reader.hpp"
#include "tools/recipe/body_mesh.hpp"
#include "tools/recipe/parts.hpp"
#include "tools/recipe/recipe.hpp"
#include "tools/recipe/stages.hpp"

namespace souple {

/// What people and build systems want to know of a bake. Nothing of it enters the asset.
struct BakeReport {
  std::vector<StageTime> stages;
  BodyMeshReport mesh;
  std::vector<RegionReport> regions;  ///< empty: one material
  TetQuality finest_quality;
  Point box_min{}, box_max{};  ///< of the final mesh, m: the frame of [[fixed]] selections
  double longest_side_m = 0;
  double sag_ratio = 0;  ///< rho g L / E: above about 1 the body is a puddle under its own weight
  double wave_ratio =
      0;  ///< c_p h / L of the shortest dynamic step: body lengths a wave runs in a step
  std::uint64_t peak_memory_bytes = 0;  ///< of this process and its children
  std::vector<std::string> notes;       ///< what the reader should know: a puddle, a kept size
  // Known once the asset was written:
  std::uint64_t asset_bytes = 0;
  std::vector<GroupCost> groups;
  std::string content_hash;
};

struct BakeOutcome {
  Asset asset;
  BakeReport report;
};

/// `generator` goes into the provenance ("souple 0.1.0"). The asset depends on the recipe and on the
/// surface's bytes only. Issues: those of check_recipe and of the stages.
Result<BakeOutcome> bake_asset(const Recipe& recipe, const std::string& generator, ProgressSink& sink);

/// An asset without compliances from given tet meshes (build_hierarchy_of).
Result<BakeOutcome> bake_hierarchy(const std::vector<std::filesystem::path>& meshes,
                                   const Recipe& recipe, const std::string& generator,
                                   ProgressSink& sink);

/// Writes the asset and adds to the report what it costs. Issues of write_asset.
Status write_baked_asset(BakeOutcome& outcome, const std::filesystem::path& file, ProgressSink& sink);

}  // namespace souple
