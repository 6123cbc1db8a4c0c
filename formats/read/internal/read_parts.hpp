// SPDX-License-Identifier: MIT
// From opened groups to plain structs, checked so far that using them is safe. Internal to the reader.
#pragma once
#include <string>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "formats/storage/group_reader.hpp"

namespace souple::storage {

/// Sizes of the finest level, from headers.
struct FinestCounts {
  std::size_t nodes = 0;
  std::size_t tets = 0;
};

Result<FinestCounts> read_level_counts(const GroupReader& level);
/// `coarse_node_count` is 0 for level 0.
Result<MeshLevel> read_level(const GroupReader& level, std::size_t coarse_node_count);
Result<Material> read_material(const GroupReader& material, const FinestCounts& finest);
Result<FixedSet> read_fixed_set(const GroupReader& set, std::string name, const FinestCounts& finest);
Result<ComplianceHeader> read_compliance_header(const GroupReader& variant, std::string name);
Result<ComplianceVariant> read_compliance(const GroupReader& variant, std::string name,
                                          const FinestCounts& finest);

}  // namespace souple::storage
