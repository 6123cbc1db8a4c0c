// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "formats/core/result.hpp"
#include "formats/read/validate.hpp"
#include "tools/cli/console.hpp"
#include "tools/cli/json_output.hpp"
#include "tools/compliance/deep_check.hpp"
#include "tools/recipe/bake.hpp"

namespace souple {

/// What was measured of one compliance, beside its header.
struct DeepResult {
  ComplianceHeader header;
  DeepCheck check;
};

/// Measures every compliance of a valid asset again (check_deeply). What stops a measurement and every
/// claim that is false becomes an issue of `report`.
std::vector<DeepResult> validate_deeply(const std::filesystem::path& file,
                                        const ComplianceStage& effort, Console& console,
                                        const ValidationOptions& options, ValidationReport& report);

Json deep_json(const std::vector<DeepResult>& results);
/// A line per compliance: what was measured and, in brackets, what the header states.
std::string deep_text(const std::vector<DeepResult>& results);

}  // namespace souple
