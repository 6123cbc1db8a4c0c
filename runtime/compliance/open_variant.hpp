// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <memory>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "runtime/compliance/rest_compliance.hpp"

namespace souple {

/// The payload of a variant, all in memory: records of a hierarchical one, else tiles of one size.
std::unique_ptr<BlockSource> memory_source(const ComplianceHeader& header,
                                           const HierarchicalIndex& hierarchy,
                                           std::vector<std::byte> payload);

/// A stored variant on the finest level: what its header names, carried up by `prolongation` where it
/// is a coarse one (coarsening 1; else `prolongation` is not used). Issues: those of
/// open_rest_compliance and ProlongedCompliance::create. `table_bytes`: as of open_rest_compliance.
Result<std::unique_ptr<const RestCompliance>> open_variant(const ComplianceHeader& header,
                                                           const HierarchicalIndex& hierarchy,
                                                           std::vector<RowProlongation> prolongation,
                                                           std::unique_ptr<BlockSource> source,
                                                           std::size_t table_bytes = 0);
/// The same from a copy of its payload.
Result<std::unique_ptr<const RestCompliance>> open_variant(const ComplianceVariant& variant);

}  // namespace souple
