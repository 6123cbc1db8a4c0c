// SPDX-License-Identifier: MIT
#include "runtime/compliance/rest_compliance.hpp"

#include "runtime/compliance/dense_tiled_compliance.hpp"

namespace souple {

Result<std::unique_ptr<const RestCompliance>> open_rest_compliance(
    const ComplianceHeader& header, std::unique_ptr<BlockSource> source) {
  if (header.representation != ComplianceRepresentation::dense_tiled)
    return make_issue(IssueCode::unsupported_feature,
                      "compliance \"" + header.name + "\" has an unknown representation");
  const TileLayout layout{static_cast<Index>(header.node_count), static_cast<Index>(header.tile_nodes)};
  if (header.node_count < 1 || header.tile_nodes < 1 || header.node_count > (Index{1} << 28) ||
      header.tile_nodes > 4096 || header.block_count != layout.block_count() ||
      header.block_scalars != layout.block_scalars())
    return make_issue(IssueCode::asset_corrupt,
                      "the blocks of the compliance do not fit its node count",
                      "compliance/" + header.name);
  std::unique_ptr<const RestCompliance> compliance;
  if (header.scalar == ScalarType::float32)
    compliance = std::make_unique<DenseTiledCompliance<float>>(layout, std::move(source));
  else
    compliance = std::make_unique<DenseTiledCompliance<double>>(layout, std::move(source));
  return compliance;
}

}  // namespace souple
