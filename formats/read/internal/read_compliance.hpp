// SPDX-License-Identifier: MIT
// The compliance variants of an asset: header, index and payload, each readable without the next.
// Internal to the reader.
#pragma once
#include <string>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "formats/read/asset_reader.hpp"
#include "formats/read/internal/checks.hpp"
#include "formats/storage/group_reader.hpp"

namespace souple::storage {

Result<ComplianceHeader> read_compliance_header(const GroupReader& variant, std::string name);
Result<ComplianceSummary> read_compliance_summary(const GroupReader& variant, std::string name);
/// All but the payload, checked against its size.
Result<ComplianceVariant> read_compliance_index(const GroupReader& variant, std::string name,
                                                const checks::MeshCounts& finest);
Result<ComplianceVariant> read_compliance(const GroupReader& variant, std::string name,
                                          const checks::MeshCounts& finest);
/// The payload's dataset, of the shape that the header says.
Result<DatasetReader> open_payload(const GroupReader& variant, const ComplianceHeader& header);

}  // namespace souple::storage
