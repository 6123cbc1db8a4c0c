// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/scene_world.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "runtime/load/load_soft_body.hpp"
#include "runtime/world/soft_body_asset.hpp"
#include "tools/exchange/nearest_name.hpp"
#include "tools/exchange/numbers.hpp"

namespace souple {
namespace {

using SharedAsset = std::shared_ptr<const SoftBodyAsset>;
using FixedSetNames = std::set<std::string>;

// The runtime's own match is on the ratio of the factors to 1e-6 (METHOD 4.2).
constexpr double ratio_tolerance = 1e-6;

std::string describe(const ComplianceHeader& header) {
  std::string text = "\"" + header.name + "\" (";
  text += header.kind == ComplianceKind::static_equilibrium
              ? "static"
              : "time step " + rounded_text(header.time_step_s, 9) + " s";
  return text +
         (header.fixed_set.empty() ? ", nothing fixed)" : ", fixed \"" + header.fixed_set + "\")");
}

Result<std::vector<ComplianceHeader>> read_headers(AssetReader& reader) {
  std::vector<ComplianceHeader> headers;
  for (const std::string& name : reader.compliance_names()) {
    auto header = reader.read_compliance_header(name);
    if (!header) return header.issue();
    headers.push_back(std::move(*header));
  }
  return headers;
}

Status check_fixed_set(const AssetReader& reader, const std::string& fixed,
                       const std::filesystem::path& file) {
  const auto& names = reader.fixed_set_names();
  if (fixed.empty() || std::ranges::find(names, fixed) != names.end()) return {};
  return make_issue(IssueCode::fixed_set_invalid,
                    "the asset has no fixed set \"" + fixed + "\"; it has " +
                        (names.empty() ? "none" : join_names(names)),
                    file.string());
}

Issue no_match(const std::vector<ComplianceHeader>& headers, double time_step_s,
               const std::string& fixed, const std::filesystem::path& file) {
  std::string held;
  for (const auto& header : headers) held += (held.empty() ? "" : ", ") + describe(header);
  return make_issue(IssueCode::scene_no_matching_compliance,
                    "the scene asks for a dynamic compliance with time step " +
                        rounded_text(time_step_s, 9) + " s and " +
                        (fixed.empty() ? "nothing fixed" : "\"" + fixed + "\" fixed") +
                        "; the asset has " + (held.empty() ? "none at all" : held),
                    file.string());
}

/// The first variant for this step and fixed set, or an issue.
Result<std::string> matching_variant(const std::vector<ComplianceHeader>& headers, double asked_ratio,
                                     double time_step_s, const std::string& fixed,
                                     const std::filesystem::path& file) {
  for (const auto& header : headers) {
    if (header.kind != ComplianceKind::dynamic_step || header.fixed_set != fixed) continue;
    const double ratio = header.mass_factor / header.stiffness_factor;
    if (std::abs(ratio - asked_ratio) <= ratio_tolerance * asked_ratio) return header.name;
  }
  return no_match(headers, time_step_s, fixed, file);
}

/// Names of the variants that the bodies of one asset need.
Result<std::vector<std::string>> variants_for(AssetReader& reader, const WorldSettings& settings,
                                              const FixedSetNames& fixed_sets,
                                              const std::filesystem::path& file) {
  auto headers = read_headers(reader);
  if (!headers) return headers.issue();
  const auto material = reader.read_material();
  if (!material) return material.issue();
  const double h = settings.time_step_s;
  const double ratio =
      (1 / (h * h) + material->rayleigh_mass_per_s / h) / (1 + material->rayleigh_stiffness_s / h);
  std::vector<std::string> names;
  for (const std::string& fixed : fixed_sets) {
    if (auto status = check_fixed_set(reader, fixed, file); !status) return status.issue();
    if (settings.contact_method == ContactMethod::exact) continue;
    auto name = matching_variant(*headers, ratio, h, fixed, file);
    if (!name) return name.issue();
    names.push_back(std::move(*name));
  }
  return names;
}

struct LoadedAsset {
  SharedAsset asset;
  AssetUse use;
};

Result<LoadedAsset> load_asset(const std::filesystem::path& file, const WorldSettings& settings,
                               const FixedSetNames& fixed_sets) {
  auto reader = AssetReader::open(file);
  if (!reader) return reader.issue();
  LoadedAsset loaded;
  LoadOptions options;
  auto names = variants_for(*reader, settings, fixed_sets, file);
  if (!names) return names.issue();
  options.compliances = *names;
  options.no_compliances = names->empty();
  auto asset = load_soft_body(*reader, options);
  if (!asset) return asset.issue();
  loaded.asset = std::move(*asset);
  std::error_code error;
  const auto file_bytes = std::filesystem::file_size(file, error);
  loaded.use = {file, error ? 0 : file_bytes, reader->bytes_read(), loaded.asset->resident_bytes(),
                std::move(*names)};
  return loaded;
}

Issue in_file(Issue issue, const std::filesystem::path& file) {
  if (issue.where.empty()) issue.where = file.string();
  return issue;
}

}  // namespace

Result<SceneWorld> build_world(const Scene& scene) {
  auto world = World::create(scene.world);
  if (!world) return world.issue();
  SceneWorld built{std::move(*world), {}, {}};
  std::map<std::filesystem::path, FixedSetNames> wanted;
  for (const SceneBody& body : scene.bodies)
    if (const auto* soft = std::get_if<SceneSoftBody>(&body))
      wanted[soft->asset.lexically_normal()].insert(soft->description.fixed_set);
  std::map<std::filesystem::path, SharedAsset> assets;
  for (const auto& [file, fixed_sets] : wanted) {
    auto loaded = load_asset(file, scene.world, fixed_sets);
    if (!loaded) return in_file(loaded.issue(), file);
    assets[file] = std::move(loaded->asset);
    built.assets.push_back(std::move(loaded->use));
  }
  for (const SceneBody& body : scene.bodies) {
    const auto* soft = std::get_if<SceneSoftBody>(&body);
    auto id = soft != nullptr
                  ? built.world.add_soft_body(assets[soft->asset.lexically_normal()], soft->description)
                  : built.world.add_rigid_body(std::get<RigidBodyDescription>(body));
    if (!id) return id.issue();
    built.bodies.push_back(*id);
  }
  return built;
}

}  // namespace souple
