// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of an asset as JSON and as lines for people; bake and inspect share them.
#pragma once
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/read/asset_reader.hpp"
#include "tools/cli/json_output.hpp"

namespace souple {

Json material_json(const Material& material);
Json compliance_json(const ComplianceHeader& header);
Json group_costs_json(const std::vector<GroupCost>& costs);

std::string compliance_text(const ComplianceHeader& header);
std::string group_costs_text(const std::vector<GroupCost>& costs);
/// "1.4 MB".
std::string bytes_text(std::uint64_t bytes);

}  // namespace souple
