// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/bake.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
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

// The decimated surface keeps more faces than the coarse mesh will have: collapsing further makes thin
// limbs cut themselves (dino.off, 1250 tets: the mesher fails on 1000 faces and works on 1500).
constexpr double faces_per_boundary_face = 4;
constexpr double fewest_faces = 1500;

// Outside these the model still works, but it is seldom what was meant.
constexpr double puddle_ratio = 2;
constexpr double rock_ratio = 1e-4;

/// Tells the sink of the stage and keeps its time.
class Stages {
 public:
  Stages(ProgressSink& sink, std::vector<StageTime>& times) : sink_(sink), times_(times) {}

  template <class Work>
  auto run(const std::string& name, const Work& work) {
    sink_.stage(name);
    const auto begin = std::chrono::steady_clock::now();
    auto result = work();
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
    times_.push_back({name, wall.count()});
    return result;
  }

 private:
  ProgressSink& sink_;
  std::vector<StageTime>& times_;
};

/// Edge of the regular tet of which `count` fill the volume: V = a^3 / (6 sqrt 2).
double edge_for(double volume_m3, double count) {
  return std::cbrt(6 * std::sqrt(2.0) * volume_m3 / count);
}

double refinement(const Recipe& recipe) {
  return std::pow(8.0, static_cast<double>(chosen_levels(recipe.mesh) - 1));
}

TetrahedralizeOptions coarse_options(const Recipe& recipe) {
  TetrahedralizeOptions options;
  const auto tets = static_cast<double>(recipe.mesh.tets);
  options.target_tet_count = static_cast<std::size_t>(std::llround(tets / refinement(recipe)));
  options.edge_length_m = recipe.mesh.edge_length_m * std::cbrt(refinement(recipe));
  return options;
}

std::size_t decimated_face_count(const TriangleMesh& surface, const TetrahedralizeOptions& coarse) {
  const double edge = coarse.edge_length_m > 0 ? coarse.edge_length_m
                                               : edge_for(std::abs(signed_volume(surface)),
                                                          static_cast<double>(coarse.target_tet_count));
  const double boundary_faces = surface_area(surface) / (std::sqrt(3.0) / 4 * edge * edge);
  const double faces = std::max(faces_per_boundary_face * boundary_faces, fewest_faces);
  return faces < 1e9 ? static_cast<std::size_t>(faces) : std::size_t{1'000'000'000};
}

Material material_of(const MaterialSettings& settings) {
  Material material;
  material.regions.push_back({"default", settings.young_pa, settings.poisson, settings.density_kg_m3});
  material.rayleigh_mass_per_s = settings.rayleigh_mass_per_s;
  material.rayleigh_stiffness_s = settings.rayleigh_stiffness_s;
  return material;
}

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

/// Meshes the decimated surface or, if the mesher cannot (decimation may leave self-intersections), the
/// whole one. With several levels the mend of a refusal names that way out too.
Result<TetrahedralizedVolume> mesh_coarsest(const TriangleMesh& decimated, const TriangleMesh& whole,
                                            const TetrahedralizeOptions& options, const Recipe& recipe,
                                            std::vector<std::string>& notes) {
  auto volume = tetrahedralize(decimated, options);
  if (!volume && decimated.triangles.size() < whole.triangles.size()) {
    auto again = tetrahedralize(whole, options);
    if (again)
      notes.push_back("the decimated surface could not be meshed; the whole one was: " +
                      volume.issue().what);
    volume = std::move(again);
  }
  if (volume || chosen_levels(recipe.mesh) == 1) return volume;
  Issue issue = volume.issue();
  issue.mend = std::string(mend_of(issue)) + " The coarsest of " +
               std::to_string(chosen_levels(recipe.mesh)) +
               " levels is what failed: fewer levels (--levels) make it finer.";
  return issue;
}

/// From the file to the levels of the mesh.
Status build_meshes(const Recipe& recipe, Stages& stages, BakeOutcome& outcome) {
  BakeReport& report = outcome.report;
  auto imported = stages.run("import", [&] {
    ImportOptions options;
    options.unit = recipe.surface.unit;
    options.size_m = recipe.surface.size_m;
    return import_surface(recipe.surface.file, options);
  });
  if (!imported) return imported.issue();
  report.import = imported->report;
  auto oriented = stages.run("orient", [&] { return orient_closed_surface(imported->mesh); });
  if (!oriented) return oriented.issue();
  report.orient = oriented->report;
  const TriangleMesh& surface = oriented->mesh;

  const TetrahedralizeOptions coarse = coarse_options(recipe);
  auto decimated = stages.run(
      "decimate", [&] { return decimate_surface(surface, {decimated_face_count(surface, coarse)}); });
  if (!decimated) return decimated.issue();
  report.decimate = decimated->report;
  auto volume = stages.run("tetrahedralize", [&] {
    return mesh_coarsest(decimated->mesh, surface, coarse, recipe, report.notes);
  });
  if (!volume) return volume.issue();
  report.coarse = volume->report;
  auto hierarchy = stages.run("hierarchy", [&] {
    NestedHierarchyOptions options;
    options.level_count = static_cast<int>(chosen_levels(recipe.mesh));
    return build_nested_hierarchy(volume->mesh, surface, options);
  });
  if (!hierarchy) return hierarchy.issue();
  report.levels = std::move(hierarchy->reports);
  outcome.asset.levels = std::move(hierarchy->levels);
  report.finest_quality = measure_tet_quality(outcome.asset.levels.back().mesh);
  return {};
}

}  // namespace

Result<BakeOutcome> bake_asset(const Recipe& recipe, const std::string& generator, ProgressSink& sink) {
  if (auto status = check_recipe(recipe); !status) return status.issue();
  BakeOutcome outcome;
  Stages stages(sink, outcome.report.stages);
  if (auto status = build_meshes(recipe, stages, outcome); !status) return status.issue();
  outcome.asset.material = material_of(recipe.material);
  if (auto status = select_fixed_sets(recipe, outcome.asset); !status) return status.issue();
  describe_scale(recipe, outcome.asset, outcome.report);
  for (const ComplianceRequest& request : recipe.compliances) {
    auto variant = stages.run("compliance " + request.name,
                              [&] { return compute_variant(request, outcome.asset, sink); });
    if (!variant) return variant.issue();
    outcome.asset.compliances.push_back(std::move(*variant));
  }
  outcome.asset.provenance = {generator, canonical_recipe_text(recipe),
                              recipe.surface.file.filename().string(), outcome.report.import.file_hash};
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
