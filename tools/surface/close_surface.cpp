// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/close_surface.hpp"

#include <array>
#include <cmath>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/surface/guarded_step.hpp"
#include "tools/surface/inner_walls.hpp"
#include "tools/surface/sew.hpp"
#include "tools/surface/shells.hpp"

namespace souple {
namespace {

/// Of the unit size: gaps and T-junctions below it are rounding of single precision files.
constexpr double sewing_tolerance = 2e-6;
/// Wider gaps are sewn only if that leaves no open edge at all.
constexpr std::array<double, 3> wider_tolerances{2e-5, 2e-4, 2e-3};
constexpr int most_sewing_passes = 8;
/// Lids beyond this share of a shell's area make it a guess.
constexpr double most_lid_share = 0.42;
/// Open pieces beyond this share of the area are not scraps.
constexpr double most_lost_share = 0.15;
/// |V| / A^1.5 of a sphere is 0.094, of a plate of 1:1000 1e-4.
constexpr double least_compactness = 1e-6;
constexpr std::size_t most_rim_edges = 4000;

SurfaceTopology topology_of(const TriangleMesh& mesh) {
  return measure_topology(mesh.triangles, mesh.vertices.size());
}

/// Steps that only help if they leave fewer open edges and no more of the other flaws.
bool is_better(const TriangleMesh& after, const TriangleMesh& before) {
  const SurfaceTopology a = topology_of(after), b = topology_of(before);
  return a.boundary_edge_count < b.boundary_edge_count &&
         a.nonmanifold_edge_count <= b.nonmanifold_edge_count;
}

struct Sewn {
  TriangleMesh mesh;
  std::size_t split = 0, merged = 0;
};

Sewn sewn(const TriangleMesh& mesh, double tolerance) {
  Sewn result{mesh, 0, 0};
  MendStep step = merge_rim_vertices(result.mesh, tolerance);
  if (step.count > 0 && is_better(step.mesh, result.mesh)) {
    result.merged = step.count;
    result.mesh = std::move(step.mesh);
  }
  for (int pass = 0; pass < most_sewing_passes; ++pass) {
    step = split_at_t_junctions(result.mesh, tolerance);
    if (step.count == 0 || !is_better(step.mesh, result.mesh)) break;
    result.split += step.count;
    result.mesh = std::move(step.mesh);
  }
  return result;
}

void sew(Mended& mended) {
  Sewn best = sewn(mended.mesh, sewing_tolerance);
  for (const double tolerance : wider_tolerances) {
    if (topology_of(best.mesh).boundary_edge_count == 0) break;
    Sewn wider = sewn(mended.mesh, tolerance);
    if (topology_of(wider.mesh).closed()) best = std::move(wider);
  }
  if (best.merged > 0) mended.actions.push_back({"merge rims", best.merged, "vertices of rims merged"});
  if (best.split > 0)
    mended.actions.push_back({"split T-junctions", best.split, "sides split at vertices of rims"});
  mended.mesh = std::move(best.mesh);
}

bool apply(Mended& mended, const std::string& name, const std::function<MendStep()>& step,
           const std::string& detail) {
  Result<MendStep> done = run_guarded(step);
  if (!done) {
    mended.failure = make_issue(done.issue().code, name + ": " + done.issue().what);
    return false;
  }
  mended.mesh = std::move(done->mesh);
  if (done->count > 0) mended.actions.push_back({name, done->count, detail});
  return true;
}

void open_inner_walls(Mended& mended) {
  MendStep step = drop_inner_walls(mended.mesh);
  if (step.count == 0) return;
  mended.mesh = std::move(step.mesh);
  mended.actions.push_back(
      {"drop inner walls", step.count, "triangles between solids that share a wall"});
}

/// Whether a shell that was filled can stand for a solid; `lids` is the area of its filled holes.
bool is_solid(const TriangleMesh& shell, double lids) {
  const double area = surface_area(shell);
  return topology_of(shell).closed() && lids <= most_lid_share * area &&
         std::abs(signed_volume(shell)) > least_compactness * std::pow(area, 1.5);
}

/// Leaves out the shells that are no solids; fails if that is too much.
void keep_solids(Mended& mended, std::size_t triangles_before_filling) {
  const std::vector<Index> shell =
      shell_of_triangles(mended.mesh.triangles, mended.mesh.vertices.size());
  std::vector<double> lids(shell.size(), 0);  // by shell
  for (std::size_t t = triangles_before_filling; t < shell.size(); ++t)
    lids[static_cast<std::size_t>(shell[t])] +=
        surface_area({mended.mesh.vertices, {mended.mesh.triangles[t]}});
  std::vector<Shell> shells = split_into_shells(mended.mesh, {});
  std::vector<TriangleMesh> solids;
  double lost = 0, whole = 0, filled = 0;
  std::size_t lost_count = 0;
  for (std::size_t s = 0; s < shells.size(); ++s) {
    const double own = surface_area(shells[s].mesh) - lids[s];
    whole += own;
    if (is_solid(shells[s].mesh, lids[s])) {
      filled += lids[s];
      solids.push_back(std::move(shells[s].mesh));
    } else {
      lost += own;
      ++lost_count;
    }
  }
  mended.lost_share = whole > 0 ? lost / whole : 1;
  mended.lid_share = filled / (whole - lost + filled + 1e-300);
  if (solids.empty() || mended.lost_share > most_lost_share) {
    mended.failure = make_issue(IssueCode::surface_not_closed,
                                std::to_string(lost_count) + " of " + std::to_string(shells.size()) +
                                    " pieces enclose nothing even with their holes filled");
    return;
  }
  if (lost_count > 0)
    mended.actions.push_back({"drop scraps", lost_count, "open pieces that enclose nothing"});
  mended.mesh = join_meshes(solids);
}

}  // namespace

void close_surface(Mended& mended) {
  if (topology_of(mended.mesh).closed_oriented_manifold()) return;
  if (!topology_of(mended.mesh).closed()) sew(mended);
  open_inner_walls(mended);
  if (topology_of(mended.mesh).closed_oriented_manifold()) return;
  if (!apply(
          mended, "orient and cut apart", [&] { return orient_and_cut(mended.mesh); },
          "vertices added where more than two triangles or several fans met"))
    return;
  const std::size_t before = mended.mesh.triangles.size();
  if (!topology_of(mended.mesh).closed()) {
    if (!apply(
            mended, "fill holes", [&] { return fill_holes(mended.mesh, most_rim_edges, 1e3); },
            "holes closed"))
      return;
  }
  keep_solids(mended, before);
}

}  // namespace souple
