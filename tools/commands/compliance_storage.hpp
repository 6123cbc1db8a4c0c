// SPDX-License-Identifier: GPL-3.0-or-later
// How a compliance lies in the file and what its use costs, by headers alone.
#pragma once
#include <string>

#include "formats/read/asset_reader.hpp"
#include "tools/cli/json_output.hpp"

namespace souple {

/// `cost` is that of the variant's group.
Json compliance_storage_json(const ComplianceSummary& summary, const GroupCost& cost);
/// Lines, each indented and ended.
std::string compliance_storage_text(const ComplianceSummary& summary, const GroupCost& cost);

}  // namespace souple
