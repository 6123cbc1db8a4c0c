// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "formats/core/result.hpp"
#include "formats/read/asset_reader.hpp"
#include "tools/cli/console.hpp"
#include "tools/recipe/bake.hpp"

namespace souple {

struct SofaExport {
  std::filesystem::path file;
  std::string variant;
  double time_step_s = 0;
  std::int64_t node_count = 0;
};

/// The system of variant `name` (empty: the only dynamic one) on all nodes of the finest level, solved
/// anew in double, in the form of tools/exchange/sofa_comp.hpp; without `file` beside the asset, under
/// the name that SOFA looks for. Issues: asset_missing_part, usage_conflict, compliance_not_exportable,
/// interrupted, those of the solves and of writing.
Result<SofaExport> export_sofa_comp(AssetReader& reader, const std::filesystem::path& asset,
                                    const std::filesystem::path& file, const std::string& name,
                                    const ComplianceStage& effort, Console& console);

}  // namespace souple
