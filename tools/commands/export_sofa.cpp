// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/export_sofa.hpp"

#include <algorithm>

#include "tools/cli/signals.hpp"
#include "tools/commands/console_progress.hpp"
#include "tools/compliance/rest_solver.hpp"
#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/nearest_name.hpp"
#include "tools/exchange/sofa_comp.hpp"

namespace souple {
namespace {

Result<ComplianceHeader> only_dynamic(AssetReader& reader) {
  std::vector<ComplianceHeader> dynamic;
  for (const std::string& name : reader.compliance_names()) {
    auto header = reader.read_compliance_header(name);
    if (!header) return header.issue();
    if (header->kind == ComplianceKind::dynamic_step) dynamic.push_back(std::move(*header));
  }
  if (dynamic.size() == 1) return std::move(dynamic.front());
  if (dynamic.empty())
    return make_issue(IssueCode::compliance_not_exportable, "the asset has no dynamic compliance");
  return make_issue(IssueCode::usage_conflict,
                    "the asset has " + std::to_string(dynamic.size()) + " dynamic compliances",
                    "--variant", "Name one of " + join_names(reader.compliance_names()) + ".");
}

Result<ComplianceHeader> header_of(AssetReader& reader, const std::string& name) {
  if (name.empty()) return only_dynamic(reader);
  const auto& names = reader.compliance_names();
  if (std::ranges::find(names, name) == names.end())
    return make_issue(IssueCode::asset_missing_part, "the asset has no compliance \"" + name + "\"",
                      "--variant", names.empty() ? std::string() : "It has " + join_names(names) + ".");
  auto header = reader.read_compliance_header(name);
  if (header && header->kind != ComplianceKind::dynamic_step)
    return make_issue(IssueCode::compliance_not_exportable, "\"" + name + "\" is static", "--variant");
  return header;
}

Result<ComplianceSystem> system_of(AssetReader& reader, const ComplianceHeader& header,
                                   const MeshLevel& level) {
  const auto material = reader.read_material();
  if (!material) return material.issue();
  FixedSet fixed;
  if (!header.fixed_set.empty()) {
    auto set = reader.read_fixed_set(header.fixed_set);
    if (!set) return set.issue();
    fixed = std::move(*set);
  }
  PreparedBody body(level, *material);
  return build_system(body, header.fixed_set.empty() ? nullptr : &fixed, {}, header.mass_factor,
                      header.stiffness_factor);
}

}  // namespace

Result<SofaExport> export_sofa_comp(AssetReader& reader, const std::filesystem::path& asset,
                                    const std::filesystem::path& file, const std::string& name,
                                    const ComplianceStage& effort, Console& console) {
  const auto header = header_of(reader, name);
  if (!header) return header.issue();
  const auto level = reader.read_level_mesh(reader.level_count() - 1);
  if (!level) return level.issue();
  const auto node_count = static_cast<Index>(level->mesh.nodes.size());
  const std::int64_t rows = 3 * std::int64_t{node_count};
  SofaExport result{file, header->name, header->time_step_s, node_count};
  if (file.empty())
    result.file = std::filesystem::path(asset).replace_filename(
        sofa_comp_name(asset.stem().string(), rows, header->time_step_s));
  if (auto status = check_output_file(result.file); !status) return status.issue();
  auto system = system_of(reader, *header, *level);
  if (!system) return system.issue();

  const InterruptFlag interrupt;
  ConsoleProgress progress(console);
  progress.stage("solve");
  FactorOptions options;
  options.memory_limit_bytes = effort.memory_limit_bytes;
  options.threads = effort.threads;
  options.cancelled = [&] { return interrupt.raised(); };
  const auto solver = RestSolver::create(std::move(*system), options);
  const Status written =
      solver ? write_sofa_comp(
                   result.file, rows, header->time_step_s,
                   [&](std::int64_t first, std::int64_t count, std::span<double> out) {
                     return full_compliance_rows(*solver, node_count, first, count, out);
                   },
                   [&](double done) { progress.fraction(done); })
             : Status(solver.issue());
  console.end_progress();
  if (!written && written.issue().code == IssueCode::interrupted) {
    console.issue(written.issue());
    interrupt.pass_on();
  }
  if (!written) return written.issue();
  return result;
}

}  // namespace souple
