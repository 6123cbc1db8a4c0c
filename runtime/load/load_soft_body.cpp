// SPDX-License-Identifier: MIT
#include "runtime/load/load_soft_body.hpp"

#include <algorithm>

#include "runtime/compliance/open_variant.hpp"
#include "runtime/load/streaming_block_source.hpp"
#include "runtime/world/soft_body_asset.hpp"

namespace souple {
namespace {

using Loaded = Result<std::shared_ptr<const SoftBodyAsset>>;
using LoadedVariant = Result<SoftBodyContent::Variant>;
using LoadVariant = std::function<LoadedVariant(const std::string& name)>;

SoftBodyContent::Variant with_source(ComplianceVariant stored, std::unique_ptr<BlockSource> source) {
  return {std::move(stored.header), std::move(stored.nodes), std::move(source),
          std::move(stored.prolongation), std::move(stored.hierarchy)};
}

LoadedVariant load_variant(AssetReader& reader, const std::string& name) {
  auto stored = reader.read_compliance(name);
  if (!stored) return stored.issue();
  auto source = memory_source(stored->header, stored->hierarchy, std::move(stored->payload));
  return with_source(std::move(*stored), std::move(source));
}

LoadedVariant stream_variant(const std::shared_ptr<SharedAssetReader>& asset, const std::string& name,
                             const LoadOptions& options) {
  const auto header = asset->reader.read_compliance_header(name);
  if (!header) return header.issue();
  if (header->representation != ComplianceRepresentation::hierarchical)
    return load_variant(asset->reader, name);
  auto stored = asset->reader.read_compliance_index(name);
  if (!stored) return stored.issue();
  auto source = StreamingBlockSource::create(asset, name, stored->hierarchy, options.streaming_failed);
  if (!source) return source.issue();
  return with_source(std::move(*stored), std::move(*source));
}

Status check_names(const AssetReader& reader, const std::vector<std::string>& names) {
  for (const auto& name : names)
    if (std::ranges::find(reader.compliance_names(), name) == reader.compliance_names().end())
      return make_issue(IssueCode::asset_missing_part, "the asset has no compliance \"" + name + "\"");
  return {};
}

Status load_multigrid(AssetReader& reader, SoftBodyContent& content) {
  if (!reader.has_multigrid()) return {};
  for (std::size_t l = 1; l < reader.level_count(); ++l) {
    auto transition = reader.read_transition(l);
    if (!transition) return transition.issue();
    content.multigrid.push_back(std::move(*transition));
  }
  auto coarsest = reader.read_level_mesh(0);
  if (!coarsest) return coarsest.issue();
  content.coarsest_nodes = std::move(coarsest->mesh.nodes);
  return {};
}

/// `load_one` reads one compliance.
Loaded load(AssetReader& reader, const LoadOptions& options, const LoadVariant& load_one) {
  if (auto status = check_names(reader, options.compliances); !status) return status.issue();
  SoftBodyContent content;
  content.table_bytes = options.table_bytes;
  auto level = reader.read_level_mesh(reader.level_count() - 1);
  if (!level) return level.issue();
  content.level = std::move(*level);
  if (options.visual && reader.has_visual()) {
    auto visual = reader.read_visual();
    if (!visual) return visual.issue();
    content.visual = std::move(*visual);
  }
  if (options.multigrid)
    if (auto status = load_multigrid(reader, content); !status) return status.issue();
  const auto solver = reader.read_default_solver();
  if (!solver) return solver.issue();
  content.default_solver = *solver;
  auto material = reader.read_material();
  if (!material) return material.issue();
  content.material = std::move(*material);
  for (const auto& name : reader.fixed_set_names()) {
    auto set = reader.read_fixed_set(name);
    if (!set) return set.issue();
    content.fixed_sets.push_back(std::move(*set));
  }
  const auto names = options.no_compliances        ? std::vector<std::string>{}
                     : options.compliances.empty() ? reader.compliance_names()
                                                   : options.compliances;
  for (const auto& name : names) {
    auto variant = load_one(name);
    if (!variant) return variant.issue();
    content.compliances.push_back(std::move(*variant));
  }
  return SoftBodyAsset::create(std::move(content));
}

}  // namespace

Loaded load_soft_body(AssetReader& reader, const LoadOptions& options) {
  if (options.streaming)
    return make_issue(IssueCode::unsupported_feature,
                      "streaming from an asset that somebody else keeps open");
  return load(reader, options, [&](const std::string& name) { return load_variant(reader, name); });
}

Loaded load_soft_body(AssetReader&& reader, const LoadOptions& options) {
  const auto asset = std::make_shared<SharedAssetReader>(std::move(reader));
  if (!options.streaming) return load_soft_body(asset->reader, options);
  // No thread reads before somebody asks for a block, and nobody can before the body is there.
  return load(asset->reader, options,
              [&](const std::string& name) { return stream_variant(asset, name, options); });
}

Loaded load_soft_body(const std::filesystem::path& file, const LoadOptions& options) {
  auto reader = AssetReader::open(file);
  if (!reader) return reader.issue();
  return load_soft_body(std::move(*reader), options);
}

}  // namespace souple
