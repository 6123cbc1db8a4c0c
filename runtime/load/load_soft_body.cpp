// SPDX-License-Identifier: MIT
#include "runtime/load/load_soft_body.hpp"

#include <algorithm>

#include "runtime/world/soft_body_asset.hpp"

namespace souple {
namespace {

std::size_t scalar_bytes(ScalarType scalar) { return scalar == ScalarType::float32 ? 4 : 8; }

Result<SoftBodyContent::Variant> load_variant(AssetReader& reader, const std::string& name) {
  auto stored = reader.read_compliance(name);
  if (!stored) return stored.issue();
  const std::size_t block_bytes =
      std::size_t(stored->header.block_scalars) * scalar_bytes(stored->header.scalar);
  return SoftBodyContent::Variant{
      std::move(stored->header), std::move(stored->nodes),
      std::make_unique<MemoryBlockSource>(std::move(stored->payload), block_bytes)};
}

Status check_names(const AssetReader& reader, const std::vector<std::string>& names) {
  for (const auto& name : names)
    if (std::ranges::find(reader.compliance_names(), name) == reader.compliance_names().end())
      return make_issue(IssueCode::asset_missing_part, "the asset has no compliance \"" + name + "\"");
  return {};
}

}  // namespace

Result<std::shared_ptr<const SoftBodyAsset>> load_soft_body(AssetReader& reader,
                                                            const LoadOptions& options) {
  if (auto status = check_names(reader, options.compliances); !status) return status.issue();
  SoftBodyContent content;
  auto level = reader.read_level_mesh(reader.level_count() - 1);
  if (!level) return level.issue();
  content.level = std::move(*level);
  if (options.visual && reader.has_visual()) {
    auto visual = reader.read_visual();
    if (!visual) return visual.issue();
    content.visual = std::move(*visual);
  }
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
    auto variant = load_variant(reader, name);
    if (!variant) return variant.issue();
    content.compliances.push_back(std::move(*variant));
  }
  return SoftBodyAsset::create(std::move(content));
}

Result<std::shared_ptr<const SoftBodyAsset>> load_soft_body(const std::filesystem::path& file,
                                                            const LoadOptions& options) {
  auto reader = AssetReader::open(file);
  if (!reader) return reader.issue();
  return load_soft_body(*reader, options);
}

}  // namespace souple
