// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/bake.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "formats/write/asset_writer.hpp"
#include "runtime/multigrid/level_transitions.hpp"
#include "tools/compliance/precompute.hpp"
#include "tools/exchange/numbers.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/recipe/choose_solver.hpp"
#include "tools/recipe/node_selection.hpp"
#include "tools/recipe/recipe_parameters.hpp"

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

/// The place of a word among the choices, which is that of the enumerator.
template <class Enum>
Enum choice(std::span<const std::string> names, const std::string& name) {
  return static_cast<Enum>(std::ranges::find(names, name) - names.begin());
}

CompliancePrecomputeOptions options_of(const ComplianceRequest& request, std::vector<Index> nodes) {
  CompliancePrecomputeOptions options;
  options.name = request.name;
  options.kind = request.kind;
  options.time_step_s = euler_step(request);
  options.tolerance = request.tolerance;
  options.norm = choice<ErrorNorm>(error_norm_names(), request.error_norm);
  options.scalar = request.scalar;
  options.nodes = std::move(nodes);
  options.coarsening = static_cast<int>(request.coarsening);
  return options;
}

/// The nodes that each compliance is limited to; empty: none of them.
Result<std::vector<std::vector<Index>>> select_regions(const std::vector<ComplianceRequest>& requests,
                                                       const std::vector<Point>& nodes) {
  std::vector<std::vector<Index>> regions(requests.size());
  for (std::size_t i = 0; i < requests.size(); ++i) {
    if (!requests[i].nodes) continue;
    auto region = select_region(*requests[i].nodes, nodes, "[[compliance]] " + requests[i].name);
    if (!region) return region.issue();
    regions[i] = std::move(*region);
  }
  return regions;
}

Result<ComplianceVariant> compute_variant(const ComplianceRequest& request, std::vector<Index> touched,
                                          const Asset& asset, PreparedBody& body,
                                          const ComplianceStage& stage, ProgressSink& sink) {
  const auto fixed = std::ranges::find(asset.fixed_sets, request.fixed, &FixedSet::name);
  CompliancePrecomputeSettings settings;
  settings.memory_limit_bytes = stage.memory_limit_bytes;
  settings.way = choice<ComplianceWay>(compliance_way_names(), request.way);
  settings.threads = stage.threads;
  settings.progress = [&sink](double done) { sink.fraction(done); };
  settings.cancelled = stage.cancelled;
  return precompute_compliance(body, asset.levels.size() > 1 ? &asset.levels.end()[-2] : nullptr,
                               fixed == asset.fixed_sets.end() ? nullptr : &*fixed,
                               options_of(request, std::move(touched)), settings);
}

/// Keeps finished stages when losing them would cost more than writing them.
class Keeper {
 public:
  Keeper(const ComplianceStage& stage, const BakeReport& report) : stage_(stage), report_(report) {}

  void keep_if_worth_it(Asset& asset) {
    double work_s = -kept_work_s_;
    for (const StageTime& time : report_.stages) work_s += time.wall_s;
    if (work_s > worth_keeping_s) keep(asset, kept_work_s_ + work_s);
  }
  void keep(Asset& asset, double work_s = 0) {
    // What cannot be kept costs time when it is missed, and nothing else.
    if (stage_.keep && stage_.keep(asset)) kept_work_s_ = work_s;
  }

 private:
  static constexpr double worth_keeping_s = 5;
  const ComplianceStage& stage_;
  const BakeReport& report_;
  double kept_work_s_ = 0;
};

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
  auto multigrid = stages.run("multigrid", [&] { return store_transitions(asset.levels); });
  if (!multigrid) return multigrid.issue();
  asset.multigrid = std::move(*multigrid);
  auto solver = stages.run("solver", [&] { return choose_solver(asset); });
  if (!solver) return solver.issue();
  asset.default_solver = *solver;
  if (auto status = select_fixed_sets(recipe, asset); !status) return status;
  describe_scale(recipe, asset, outcome.report);
  if (recipe.surface.size_m == 0)
    outcome.report.notes.push_back(
        "no size_m was given: the surface keeps its own size, longest side " +
        rounded_text(outcome.report.longest_side_m) + " m");
  Recipe effective = recipe;
  effective.mesh.levels = static_cast<std::int64_t>(asset.levels.size());
  asset.provenance = {generator, canonical_recipe_text(effective), outcome.report.mesh.input_name,
                      outcome.report.mesh.input_hash + regions->file_hashes};
  return {};
}

}  // namespace

Result<BakeOutcome> bake_body(const Recipe& recipe, const std::string& generator, ProgressSink& sink) {
  if (auto status = check_recipe(recipe); !status) return status.issue();
  BakeOutcome outcome;
  Stages stages(sink, outcome.report.stages);
  auto body = build_body_mesh(recipe, stages);
  if (!body) return body.issue();
  if (auto status = finish_body(std::move(*body), recipe, generator, stages, outcome); !status)
    return status.issue();
  outcome.report.peak_memory_bytes = peak_memory_bytes();
  return outcome;
}

Status add_compliances(BakeOutcome& outcome, const Recipe& recipe, const ComplianceStage& stage,
                       ProgressSink& sink) {
  Asset& asset = outcome.asset;
  // The mesher may have made fewer levels than were asked for.
  const auto level_count = static_cast<std::int64_t>(asset.levels.size());
  std::vector<std::string> fixed_sets;
  for (const FixedSet& set : asset.fixed_sets) fixed_sets.push_back(set.name);
  if (auto status = check_compliances(recipe.compliances, level_count, fixed_sets); !status)
    return status;
  // All of them before hours are spent on the first.
  auto regions = select_regions(recipe.compliances, asset.levels.back().mesh.nodes);
  if (!regions) return regions.issue();
  Stages stages(sink, outcome.report.stages);
  Keeper keeper(stage, outcome.report);
  PreparedBody body(asset.levels.back(), asset.material);
  for (std::size_t i = 0; i < recipe.compliances.size(); ++i) {
    const ComplianceRequest& request = recipe.compliances[i];
    const auto is_this = [&](const auto& variant) { return variant.header.name == request.name; };
    if (std::ranges::any_of(asset.compliances, is_this)) continue;
    keeper.keep_if_worth_it(asset);
    auto variant = stages.run("compliance " + request.name, [&] {
      return compute_variant(request, std::move((*regions)[i]), asset, body, stage, sink);
    });
    if (!variant) {
      if (variant.issue().code == IssueCode::interrupted) keeper.keep(asset);
      return variant.issue();
    }
    asset.compliances.push_back(std::move(*variant));
  }
  outcome.report.peak_memory_bytes = peak_memory_bytes();
  return {};
}

Result<BakeOutcome> bake_asset(const Recipe& recipe, const std::string& generator, ProgressSink& sink,
                               const ComplianceStage& stage) {
  auto outcome = bake_body(recipe, generator, sink);
  if (!outcome) return outcome;
  if (auto status = add_compliances(*outcome, recipe, stage, sink); !status) return status.issue();
  return outcome;
}

BakeOutcome outcome_of(Asset asset, const Recipe& recipe) {
  BakeOutcome outcome;
  outcome.asset = std::move(asset);
  BakeReport& report = outcome.report;
  report.mesh.input_name = outcome.asset.provenance.input_name;
  report.mesh.input_hash = outcome.asset.provenance.input_hash;
  constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();
  for (const MeshLevel& level : outcome.asset.levels) {
    const TetQuality quality = measure_tet_quality(level.mesh);
    LevelReport& r = report.mesh.levels.emplace_back();
    r.node_count = level.mesh.nodes.size();
    r.tet_count = level.mesh.tets.size();
    r.min_dihedral_deg = quality.min_dihedral_deg;
    r.worst_radius_ratio = quality.worst_radius_ratio;
    r.worst_aspect = quality.worst_aspect;
    r.rigid_motion_error = level.rigid_motion_error;
    r.distance.forth = r.distance.back = {not_measured, not_measured};
    report.finest_quality = quality;
  }
  describe_scale(recipe, outcome.asset, report);
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
