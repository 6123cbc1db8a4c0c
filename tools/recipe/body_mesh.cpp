// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/body_mesh.hpp"

#include <string>

#include "tools/hierarchy/embed_points.hpp"
#include "tools/hierarchy/embedded_hierarchy.hpp"
#include "tools/recipe/stage_options.hpp"

namespace souple {
namespace {

/// A surface in metres on its way to becoming a volume.
struct Source {
  TriangleMesh given;   ///< as imported
  TriangleMesh closed;  ///< repaired
};

/// Degrees: below it another way to a volume is tried, with and without sharp edges.
constexpr double poor_dihedral_sharp = 5, poor_dihedral_smooth = 10;

double flattest(const TetrahedralizedVolume& volume) { return volume.report.quality.min_dihedral_deg; }

bool is_good(const Result<TetrahedralizedVolume>& volume) {
  if (!volume) return false;
  return flattest(*volume) >=
         (volume->report.features.kept ? poor_dihedral_sharp : poor_dihedral_smooth);
}

Issue fault_of(const Result<TetrahedralizedVolume>& volume) {
  if (!volume) return volume.issue();
  return make_issue(IssueCode::meshing_failed,
                    "the smallest dihedral angle is " + std::to_string(flattest(*volume)) + " degrees");
}

/// The ways to a volume, each tried where the one before fails or leaves flat tets: the Delaunay mesher
/// on the decimated surface, on the whole one (decimation may fold thin parts), on a wrap of it (slits
/// and near-touching sheets, which repair leaves, send the mesher astray: camel.off, cow.off), and the
/// lattice.
class VolumeWays {
 public:
  VolumeWays(const Recipe& recipe, const Source& source, Stages& stages, BodyMeshReport& report)
      : recipe_(recipe), source_(source), stages_(stages), report_(report) {}

  /// Without `last_ways` only the first two, which keep the shape.
  Result<TetrahedralizedVolume> mesh(const TetrahedralizeOptions& options, bool last_ways) {
    if (options.mesher == MesherKind::lattice) return tets_of(source_.closed, options, "");
    TetrahedralizeOptions delaunay = options;
    delaunay.mesher = MesherKind::delaunay;
    const DecimateOptions fewer = decimate_options(recipe_, source_.closed, options);
    auto decimated = decimated_surface(source_.closed, fewer, true);
    auto volume = decimated ? tets_of(*decimated, delaunay, "") : decimated.issue();
    if (is_good(volume) || (!volume && volume.issue().code == IssueCode::usage_bad_value))
      return volume;
    const Issue first = fault_of(volume);
    if (!volume && decimated && decimated->triangles.size() < source_.closed.triangles.size())
      volume = tets_of(source_.closed, delaunay, "the whole surface was meshed: decimated, ", &first);
    if (is_good(volume) || !last_ways) return volume;
    auto wrap = wrapped(delaunay, fewer, first);
    if (wrap && (!volume || flattest(*wrap) > flattest(*volume))) volume = std::move(wrap);
    if (volume || options.mesher == MesherKind::delaunay) return volume ? std::move(volume) : first;
    delaunay.mesher = MesherKind::lattice;
    return tets_of(source_.closed, delaunay, "the lattice was taken: ", &first);
  }

 private:
  Result<TriangleMesh> decimated_surface(const TriangleMesh& surface, const DecimateOptions& options,
                                         bool report_it) {
    auto decimated = stages_.run("decimate", [&] { return decimate_surface(surface, options); });
    if (!decimated) return decimated.issue();
    if (report_it && !report_.decimate) report_.decimate = std::move(decimated->report);
    return std::move(decimated->mesh);
  }

  /// `instead`: what to note of a success after the failure `first`.
  Result<TetrahedralizedVolume> tets_of(const TriangleMesh& surface,
                                        const TetrahedralizeOptions& options,
                                        const std::string& instead, const Issue* first = nullptr) {
    auto volume = stages_.run("tetrahedralize", [&] { return tetrahedralize(surface, options); });
    if (volume && first != nullptr) volume->report.notes.push_back(instead + first->what);
    return volume;
  }

  Result<TetrahedralizedVolume> wrapped(const TetrahedralizeOptions& options,
                                        const DecimateOptions& fewer, const Issue& first) {
    RepairOptions wrap = repair_options(recipe_);
    wrap.mode = RepairMode::wrap;
    auto surface = stages_.run("wrap", [&] { return repair_surface(source_.closed, wrap); });
    if (!surface) return surface.issue();
    const std::string note = "a wrap of the surface was meshed: ";
    if (auto decimated = decimated_surface(surface->mesh, fewer, false))
      if (auto volume = tets_of(*decimated, options, note, &first)) return volume;
    return tets_of(surface->mesh, options, note, &first);
  }

  const Recipe& recipe_;
  const Source& source_;
  Stages& stages_;
  BodyMeshReport& report_;
};

Status import_source(const Recipe& recipe, Source& source, BodyMeshReport& report) {
  auto imported = import_surface(recipe.surface.file, import_options(recipe));
  if (!imported) return imported.issue();
  source.given = std::move(imported->mesh);
  report.input_hash = imported->report.file_hash;
  report.scale = imported->report.scale;
  report.import = std::move(imported->report);
  return {};
}

/// Coarsest mesh first; one mesh if nested, one per level if embedded.
Result<std::vector<TetMesh>> mesh_volume(const Recipe& recipe, const Source& source,
                                         const std::vector<LocalSize>& local_sizes, bool last_ways,
                                         Stages& stages, BodyMeshReport& report) {
  const bool embedded = recipe.mesh.hierarchy == "embedded";
  std::vector<TetMesh> meshes;
  for (std::int64_t l = 0; l < (embedded ? chosen_levels(recipe) : 1); ++l) {
    VolumeWays ways(recipe, source, stages, report);
    auto volume = ways.mesh(mesher_options(recipe, local_sizes, l), last_ways);
    if (!volume) return volume.issue();
    const auto& said = volume->report.notes;
    report.notes.insert(report.notes.end(), said.begin(), said.end());
    if (l == 0) report.coarse = std::move(volume->report);
    meshes.push_back(std::move(volume->mesh));
  }
  return meshes;
}

/// Where the levels were not asked for, one is taken if a coarse mesh would lose thin parts of the
/// shape (on a camel the lattice's coarse cage has 3.6 times its volume).
/// `recipe` becomes what was done. With several levels the mend of a refusal names that way out too.
Result<std::vector<TetMesh>> mesh_with_levels(Recipe& recipe, const Source& source,
                                              const std::vector<LocalSize>& local_sizes, Stages& stages,
                                              BodyMeshReport& report) {
  const bool is_free = recipe.mesh.levels == 0 && chosen_levels(recipe) > 1;
  auto meshes = mesh_volume(recipe, source, local_sizes, !is_free, stages, report);
  if (meshes || chosen_levels(recipe) == 1) return meshes;
  if (is_free) {
    report.notes.push_back("one level: a coarser mesh would not hold the shape (" +
                           meshes.issue().what + ")");
    recipe.mesh.levels = 1;
    report.decimate.reset();
    return mesh_volume(recipe, source, local_sizes, true, stages, report);
  }
  Issue issue = meshes.issue();
  issue.mend = std::string(mend_of(issue)) + " The coarsest of " +
               std::to_string(chosen_levels(recipe)) +
               " levels is what failed: fewer levels (--levels) make it finer.";
  return issue;
}

Status bind_visual(const TriangleMesh& surface, Stages& stages, BodyMesh& body) {
  const auto bound =
      stages.run("visual", [&] { return embed_points(surface.vertices, body.levels.back().mesh); });
  if (!bound) return bound.issue();
  body.visual = {surface, bound->rows};
  body.report.visual = {surface.vertices.size(), bound->outside_count, bound->farthest_outside_m,
                        bound->largest_weight};
  return {};
}

Status keep_hierarchy(Result<Hierarchy> hierarchy, BodyMesh& body) {
  if (!hierarchy) return hierarchy.issue();
  body.report.levels = std::move(hierarchy->reports);
  body.levels = std::move(hierarchy->levels);
  return {};
}

/// From a surface that may need repair to levels.
Status build_from_surface(const Recipe& recipe, Source& source, Stages& stages, BodyMesh& body) {
  auto repaired =
      stages.run("repair", [&] { return repair_surface(source.given, repair_options(recipe)); });
  if (!repaired) return repaired.issue();
  body.report.repair = std::move(repaired->report);
  source.closed = std::move(repaired->mesh);
  auto parts = read_local_sizes(recipe, source.closed, body.report.scale);
  if (!parts) return parts.issue();
  body.report.input_hash += parts->file_hashes;
  Recipe effective = recipe;
  auto meshes = mesh_with_levels(effective, source, parts->local_sizes, stages, body.report);
  if (!meshes) return meshes.issue();
  const auto hierarchy = stages.run("hierarchy", [&] {
    return keep_hierarchy(meshes->size() > 1 ? build_embedded_hierarchy(*meshes, source.closed)
                                             : build_nested_hierarchy(meshes->front(), source.closed,
                                                                      nested_options(effective)),
                          body);
  });
  if (!hierarchy) return hierarchy;
  if (recipe.mesh.visual == "none") return {};
  return bind_visual(source.given, stages, body);
}

TriangleMesh boundary_of(const TetMesh& mesh) { return {mesh.nodes, boundary_triangles(mesh.tets)}; }

void keep_import(ImportTetsReport report, BodyMesh& body) {
  body.report.input_hash = report.file_hash;
  body.report.scale = report.scale;
  body.report.import_tets = std::move(report);
}

/// Red refinement of a given mesh. Without a target its boundary stays as it is.
Status refine_given(const Recipe& recipe, const ImportedTets& tets, const TriangleMesh* target,
                    Stages& stages, BodyMesh& body) {
  NestedHierarchyOptions options = nested_options(recipe);
  if (target == nullptr) options.fit = FitRule::none;
  const auto hierarchy = stages.run("hierarchy", [&] {
    return keep_hierarchy(
        build_nested_hierarchy(tets.mesh, target ? *target : boundary_of(tets.mesh), options), body);
  });
  if (!hierarchy) return hierarchy;
  // Red refinement keeps the children of a tet together, in the order of the tets.
  body.labels.names = tets.label_names;
  const std::size_t children = body.levels.back().mesh.tets.size() / tets.mesh.tets.size();
  for (const Index label : tets.labels)
    body.labels.of_tets.insert(body.labels.of_tets.end(), children, label);
  return {};
}

Status build_from_tet_file(const Recipe& recipe, Stages& stages, BodyMesh& body) {
  auto tets = stages.run("import",
                         [&] { return import_tets(recipe.surface.file, import_tets_options(recipe)); });
  if (!tets) return tets.issue();
  keep_import(tets->report, body);
  if (keeps_given_tets(recipe) && !tets->mesh.tets.empty())
    return refine_given(recipe, *tets, nullptr, stages, body);
  Source source;
  source.given = tets->mesh.tets.empty() ? std::move(tets->triangles) : boundary_of(tets->mesh);
  Recipe meshed = recipe;
  if (keeps_given_tets(recipe)) {
    meshed.mesh.tets = default_tets;
    body.report.notes.push_back("the file holds triangles only: they are filled with tets");
  }
  return build_from_surface(meshed, source, stages, body);
}

Result<std::vector<ImportedTets>> import_meshes(const std::vector<std::filesystem::path>& files,
                                                const Recipe& recipe) {
  std::vector<ImportedTets> meshes;
  for (const auto& file : files) {
    auto mesh = import_tets(file, import_tets_options(recipe));
    if (!mesh) return mesh.issue();
    if (mesh->mesh.tets.empty())
      return make_issue(IssueCode::tet_file_no_tets,
                        std::to_string(mesh->triangles.triangles.size()) + " triangles and no tets",
                        file.string());
    meshes.push_back(std::move(*mesh));
  }
  return meshes;
}

Status embed_given(const std::vector<ImportedTets>& given, const TriangleMesh* target, Stages& stages,
                   BodyMesh& body) {
  std::vector<TetMesh> meshes;
  for (const ImportedTets& tets : given) meshes.push_back(tets.mesh);
  body.labels = {given.back().labels, given.back().label_names};
  return stages.run("hierarchy", [&] {
    return keep_hierarchy(
        build_embedded_hierarchy(meshes, target ? *target : boundary_of(meshes.back())), body);
  });
}

}  // namespace

Result<BodyMesh> build_hierarchy_of(const std::vector<std::filesystem::path>& files,
                                    const Recipe& recipe, Stages& stages) {
  BodyMesh body;
  auto given = stages.run("import", [&] { return import_meshes(files, recipe); });
  if (!given) return given.issue();
  keep_import(given->back().report, body);
  body.report.input_name = files.back().filename().string();
  Source target;
  const bool has_target = !recipe.surface.file.empty();
  if (has_target)
    if (auto status = import_source(recipe, target, body.report); !status) return status.issue();
  const TriangleMesh* surface = has_target ? &target.given : nullptr;
  const Status built = given->size() > 1 ? embed_given(*given, surface, stages, body)
                                         : refine_given(recipe, given->front(), surface, stages, body);
  if (!built) return built.issue();
  if (has_target && recipe.mesh.visual != "none")
    if (auto status = bind_visual(*surface, stages, body); !status) return status.issue();
  return body;
}

Result<BodyMesh> build_body_mesh(const Recipe& recipe, Stages& stages) {
  BodyMesh body;
  body.report.input_name = recipe.surface.file.filename().string();
  Status built;
  if (is_tet_file_name(recipe.surface.file)) {
    built = build_from_tet_file(recipe, stages, body);
  } else {
    Source source;
    built = stages.run("import", [&] { return import_source(recipe, source, body.report); });
    if (built) built = build_from_surface(recipe, source, stages, body);
  }
  if (!built) return built.issue();
  return body;
}

}  // namespace souple
