// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/deep_validation.hpp"

#include <optional>

#include "formats/read/asset_reader.hpp"
#include "tools/commands/console_progress.hpp"
#include "tools/exchange/numbers.hpp"

namespace souple {
namespace {

void add_issue(const Issue& issue, const ValidationOptions& options, ValidationReport& report) {
  if (report.issues.size() < options.issue_cap)
    report.issues.push_back(issue);
  else
    ++report.suppressed_count;
}

/// What all compliances of the asset are measured against.
struct Body {
  MeshLevel finest;
  Material material;
};

Result<Body> read_body(AssetReader& reader) {
  auto finest = reader.read_level(reader.level_count() - 1);
  if (!finest) return finest.issue();
  auto material = reader.read_material();
  if (!material) return material.issue();
  return Body{std::move(*finest), std::move(*material)};
}

Result<DeepResult> check_one(AssetReader& reader, const Body& body, const std::string& name,
                             const DeepCheckOptions& options) {
  const auto variant = reader.read_compliance(name);
  if (!variant) return variant.issue();
  std::optional<FixedSet> fixed;
  if (!variant->header.fixed_set.empty()) {
    auto set = reader.read_fixed_set(variant->header.fixed_set);
    if (!set) return set.issue();
    fixed = std::move(*set);
  }
  auto check = check_deeply(*variant, body.finest, body.material, fixed ? &*fixed : nullptr, options);
  if (!check) return check.issue();
  return DeepResult{variant->header, std::move(*check)};
}

}  // namespace

std::vector<DeepResult> validate_deeply(const std::filesystem::path& file,
                                        const ComplianceStage& effort, Console& console,
                                        const ValidationOptions& options, ValidationReport& report) {
  std::vector<DeepResult> results;
  auto reader = AssetReader::open(file);
  const auto body = reader ? read_body(*reader) : Result<Body>(reader.issue());
  if (!body) {
    add_issue(body.issue(), options, report);
    return results;
  }
  ConsoleProgress progress(console);
  for (const std::string& name : reader->compliance_names()) {
    progress.stage("measure " + name);
    DeepCheckOptions deep;
    deep.factor.memory_limit_bytes = effort.memory_limit_bytes;
    deep.factor.threads = effort.threads;
    deep.progress = [&](double done) { progress.fraction(done); };
    auto result = check_one(*reader, *body, name, deep);
    if (!result) {
      add_issue(result.issue(), options, report);
      continue;
    }
    for (const Issue& issue : result->check.false_claims) add_issue(issue, options, report);
    results.push_back(std::move(*result));
  }
  console.end_progress();
  return results;
}

Json deep_json(const std::vector<DeepResult>& results) {
  Json list = Json::array();
  for (const auto& [header, check] : results)
    list.push_back({{"name", header.name},
                    {"holds", check.false_claims.empty()},
                    {"scaled_spectral_at_least", check.scaled_spectral},
                    {"frobenius_of_sample", check.frobenius},
                    {"worst_column_of_sample", check.worst_column},
                    {"least_curvature", check.least_curvature},
                    {"reference_residual", check.reference_residual}});
  return list;
}

std::string deep_text(const std::vector<DeepResult>& results) {
  std::string text;
  const auto pair = [](double measured, double stated) {
    return rounded_text(measured, 3) + " (" + rounded_text(stated, 3) + ")";
  };
  for (const auto& [header, check] : results)
    text += "compliance " + header.name + ", measured (stated): scaled spectral error " +
            pair(check.scaled_spectral, header.error.scaled_spectral) + ", Frobenius " +
            pair(check.frobenius, header.error.frobenius) + ", worst column " +
            pair(check.worst_column, header.error.worst_column) + ", residual of the reference " +
            rounded_text(check.reference_residual, 2) + "\n";
  return text;
}

}  // namespace souple
