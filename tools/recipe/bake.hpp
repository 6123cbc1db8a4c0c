// SPDX-License-Identifier: GPL-3.0-or-later
// The pipeline: file -> mesh of the body -> material and fixed sets -> compliances -> asset.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
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

/// What the stage of the compliances may use, and how it is told to stop.
struct ComplianceStage {
  std::size_t memory_limit_bytes = std::size_t{16} << 30;
  unsigned threads = 2;             ///< the asset does not depend on it
  std::function<bool()> cancelled;  ///< may be empty; asked often; true: issue `interrupted`
  /// May be empty. Keeps the finished stages: called before the stage is left by an interrupt, and
  /// after work that took long enough to be sorry for.
  std::function<Status(Asset& unfinished)> keep;
};

/// All but the compliances. `generator` goes into the provenance ("souple 0.1.0"). The asset depends on
/// the recipe and on the surface's bytes only. Issues: those of check_recipe and of the stages.
Result<BakeOutcome> bake_body(const Recipe& recipe, const std::string& generator, ProgressSink& sink);

/// The compliances that the recipe asks for and the asset does not hold yet. Issues: those of
/// precompute_compliance, recipe_needs_coarser_level, compliance_region_empty.
Status add_compliances(BakeOutcome& outcome, const Recipe& recipe, const ComplianceStage& stage,
                       ProgressSink& sink);

/// Both.
Result<BakeOutcome> bake_asset(const Recipe& recipe, const std::string& generator, ProgressSink& sink,
                               const ComplianceStage& stage = {});

/// A report on a body that was made by another run: what can be measured on it.
BakeOutcome outcome_of(Asset asset, const Recipe& recipe);

/// An asset without compliances from given tet meshes (build_hierarchy_of).
Result<BakeOutcome> bake_hierarchy(const std::vector<std::filesystem::path>& meshes,
                                   const Recipe& recipe, const std::string& generator,
                                   ProgressSink& sink);

/// Writes the asset and adds to the report what it costs. Issues of write_asset.
Status write_baked_asset(BakeOutcome& outcome, const std::filesystem::path& file, ProgressSink& sink);

}  // namespace souple
