// SPDX-License-Identifier: MIT
#include "runtime/compliance/open_variant.hpp"

#include <utility>

#include "runtime/compliance/prolonged_compliance.hpp"

namespace souple {

std::unique_ptr<BlockSource> memory_source(const ComplianceHeader& header,
                                           const HierarchicalIndex& hierarchy,
                                           std::vector<std::byte> payload) {
  if (header.representation == ComplianceRepresentation::hierarchical)
    return std::make_unique<MemoryBlockSource>(std::move(payload), hierarchy.record_begin);
  const std::size_t scalar_bytes = header.scalar == ScalarType::float32 ? 4 : 8;
  return std::make_unique<MemoryBlockSource>(std::move(payload),
                                             std::size_t(header.block_scalars) * scalar_bytes);
}

Result<std::unique_ptr<const RestCompliance>> open_variant(const ComplianceHeader& header,
                                                           const HierarchicalIndex& hierarchy,
                                                           std::vector<RowProlongation> prolongation,
                                                           std::unique_ptr<BlockSource> source,
                                                           std::size_t table_bytes) {
  auto rest = open_rest_compliance(header, hierarchy, std::move(source), table_bytes);
  if (!rest || header.coarsening == 0) return rest;
  return ProlongedCompliance::create(std::move(*rest), std::move(prolongation),
                                     "compliance/" + header.name);
}

Result<std::unique_ptr<const RestCompliance>> open_variant(const ComplianceVariant& variant) {
  return open_variant(variant.header, variant.hierarchy, variant.prolongation,
                      memory_source(variant.header, variant.hierarchy, variant.payload));
}

}  // namespace souple
