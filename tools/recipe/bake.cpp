// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/bake.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/write/asset_writer.hpp"
#include "tools/compliance/precompute.hpp"
#include "tools/exchange/numbers.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/recipe/node_selection.hpp"

namespace souple {
namespace {

constexpr double gravity_m_s2 = 9.81;

// Outside these the model still works, but it is seldom what was meant.
constexpr double puddle_ratio = 2;
constexpr double rock_ratio = 1e-4;

Status select_fixed_sets(const Recipe& recipe, Asset& asset) {
  for (const FixedRequest& request : recipe.fixed) {
    auto set = select_nodes(request, asset.levels.back().mesh.nodes);
    if (!set) return set.issue();
    asset.fixed_sets.push_back(std::move(*set));
  }
  return {};
}

Result<ComplianceVariant> compute_variant(const ComplianceRequest& request, const Asset& asset,
                                          ProgressSink& sink) {
  const auto fixed = std::ranges::find(asset.fixed_sets, request.fixed, &FixedSet::name);
  CompliancePrecomputeOptions options;
  options.name = request.name;
  options.kind = request.kind;
  options.time_step_s = request.time_step_s;
  options.scalar = request.scalar;
  options.progress = [&sink](double done) { sink.fraction(done); };
  return precompute_compliance(asset.levels.back(), asset.material,
                               fixed == asset.fixed_sets.end() ? nullptr : &*fixed, options);
}

/// c_p h / L with c_p = sqrt(E (1 - nu) / ((1 + nu) (1 - 2 nu) rho)) and the shortest dynamic step.
double wave_ratio(const Recipe& recipe, double length_m) {
  double step = std::numeric_limits<double>::infinity();
  for (const auto& request : recipe.compliances)
    if (request.kind == ComplianceKind::dynamic_step) step = std::min(step, request.time_step_s);
  if (!std::isfinite(step)) return 0;
  const auto& m = recipe.material;
  const double modulus = m.young_pa * (1 - m.poisson) / ((1 + m.poisson) * (1 - 2 * m.poisson));
  return std::sqrt(modulus / m.density_kg_m3) * step / length_m;
}

void describe_scale(const Recipe& recipe, const Asset& asset, BakeReport& report) {
  const Box box = bounding_box(asset.levels.back().mesh.nodes);
  report.box_min = box.low;
  report.box_max = box.high;
  report.longest_side_m = longest_side(box);
  const auto& m = recipe.material;
  report.sag_ratio = m.density_kg_m3 * gravity_m_s2 * report.longest_side_m / m.young_pa;
  report.wave_ratio = wave_ratio(recipe, report.longest_side_m);
  if (recipe.surface.size_m == 0)
    report.notes.push_back("no size_m was given: the surface keeps its own size, longest side " +
                           rounded_text(report.longest_side_m) + " m");
  const std::string ratio = "rho g L / E = " + rounded_text(report.sag_ratio, 2);
  if (report.sag_ratio > puddle_ratio)
    report.notes.push_back(ratio + ": under its own weight this body is a puddle; check size and E");
  if (report.sag_ratio < rock_ratio)
    report.notes.push_back(ratio + ": this body is a rock; check size and E");
}

std::uint64_t peak_memory_bytes() {
  rusage self{}, children{};
  getrusage(RUSAGE_SELF, &self);
  getrusage(RUSAGE_CHILDREN, &children);
  return 1024 * static_cast<std::uint64_t>(std::max(self.ru_maxrss, children.ru_maxrss));  // KiB
}

/// An asset that lacks only compliances.
Status finish_body(BodyMesh body, const Recipe& recipe, const std::string& generator, Stages& stages,
                   BakeOutcome& outcome) {
  Asset& asset = outcome.asset;
  asset.levels = std::move(body.levels);
  asset.visual = std::move(body.visual);
  outcome.report.mesh = std::move(body.report);
  outcome.report.notes = outcome.report.mesh.notes;
  const TetMesh& finest = asset.levels.back().mesh;
  outcome.report.finest_quality = measure_tet_quality(finest);
  auto regions = stages.run("material", [&] {
    return assign_regions(recipe, finest, body.labels, outcome.report.mesh.scale);
  });
  if (!regions) return regions.issue();
  asset.material = {std::move(regions->regions), std::move(regions->tet_region),
                    recipe.material.rayleigh_mass_per_s, recipe.material.rayleigh_stiffness_s};
  outcome.report.regions = std::move(regions->reports);
  if (auto status = select_fixed_sets(recipe, asset); !status) return status;
  describe_scale(recipe, asset, outcome.report);
  Recipe effective = recipe;
  effective.mesh.levels = static_cast<std::int64_t>(asset.levels.size());
  asset.provenance = {generator, canonical_recipe_text(effective), outcome.report.mesh.input_name,
                      outcome.report.mesh.input_hash + regions->file_hashes};
  return {};
}

}  // namespace

Result<BakeOutcome> bake_asset(const Recipe& recipe, const std::string& generator, ProgressSink& sink) {
  if (auto status = check_recipe(recipe); !status) return status.issue();
  BakeOutcome outcome;
  Stages stages(sink, outcome.report.stages);
  auto body = build_body_mesh(recipe, stages);
  if (!body) return body.issue();
  if (auto status = finish_body(std::move(*body), recipe, generator, stages, outcome); !status)
    return status.issue();
  for (const ComplianceRequest& request : recipe.compliances) {
    auto variant = stages.run("compliance " + request.name,
                              [&] { return compute_variant(request, outcome.asset, sink); });
    if (!variant) return variant.issue();
    outcome.asset.compliances.push_back(std::move(*variant));
  }
  outcome.report.peak_memory_bytes = peak_memory_bytes();
  return outcome;
}

Result<BakeOutcome> bake_hierarchy(const std::vector<std::filesystem::path>& meshes,
                                   const Recipe& recipe, const std::string& generator,
                                   ProgressSink& sink) {
  BakeOutcome outcome;
  Stages stages(sink, outcome.report.stages);
  auto body = build_hierarchy_of(meshes, recipe, stages);
  if (!body) return body.issue();
  if (auto status = finish_body(std::move(*body), recipe, generator, stages, outcome); !status)
    return status.issue();
  outcome.report.peak_memory_bytes = peak_memory_bytes();
  return outcome;
}

Status write_baked_asset(BakeOutcome& outcome, const std::filesystem::path& file, ProgressSink& sink) {
  BakeReport& report = outcome.report;
  Stages stages(sink, report.stages);
  if (auto status = stages.run("write", [&] { return write_asset(outcome.asset, file); }); !status)
    return status;
  auto reader = AssetReader::open(file);
  if (!reader) return reader.issue();
  auto costs = reader->group_costs();
  if (!costs) return costs.issue();
  report.groups = std::move(*costs);
  report.content_hash = reader->content_hash();
  std::error_code error;
  report.asset_bytes = std::filesystem::file_size(file, error);
  report.peak_memory_bytes = peak_memory_bytes();
  return {};
}

}  // namespace souple
