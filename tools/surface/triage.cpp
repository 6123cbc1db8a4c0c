// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/triage.hpp"

#include <algorithm>
#include <array>
#include <exception>

#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"
#include "tools/surface/boundary_loops.hpp"
#include "tools/surface/clean_soup.hpp"
#include "tools/surface/flatness.hpp"
#include "tools/surface/self_intersections.hpp"
#include "tools/surface/shells.hpp"

namespace souple {
namespace {

/// A single piece whose holes would need lids of this share of the closed area is a patch: a flat one
/// has a half, a hemisphere a third, a cube without a face a sixth.
constexpr double patch_lid_share = 0.45;
/// Loose patches that cut each other more often than this, a triangle, are no surface of anything.
constexpr double jumble_pairs_per_triangle = 2;
/// Beyond these the surface is better wrapped than mended.
constexpr double large_lid_share = 0.1;
constexpr double heavy_intersection_share = 0.05;
constexpr double heavy_nonmanifold_share = 0.02;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Status check_soup(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return make_issue(IssueCode::surface_no_triangles, "no triangles");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!is_finite(mesh.vertices[i]))
      return make_issue(IssueCode::surface_invalid, "vertex " + std::to_string(i) + " is not finite");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const Index i : mesh.triangles[t])
      if (i < 0 || at(i) >= mesh.vertices.size())
        return make_issue(IssueCode::surface_invalid,
                          "triangle " + std::to_string(t) + " names a vertex outside the mesh");
  return {};
}

/// Degenerate and repeated triangles, which the other counts leave out.
void count_dropped(const TriangleMesh& surface, const TriangleMesh& cleaned, SurfaceTriage& triage) {
  const std::vector<Index> first = first_at_position(surface.vertices);
  std::vector<Triangle> merged;
  for (const Triangle& t : surface.triangles)
    merged.push_back({first[at(t[0])], first[at(t[1])], first[at(t[2])]});
  // What clean_soup drops that does not repeat another triangle has no area.
  const auto repeats = repeated_triangles(merged);
  const std::size_t dropped = surface.triangles.size() - cleaned.triangles.size();
  for (std::size_t t = 0; t < merged.size(); ++t) {
    const Triangle& v = merged[t];
    const bool is_point_or_line = v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
    if (repeats[t] && !is_point_or_line) ++triage.duplicate_triangle_count;
  }
  triage.duplicate_triangle_count = std::min(triage.duplicate_triangle_count, dropped);
  triage.degenerate_triangle_count = dropped - triage.duplicate_triangle_count;
}

struct Extent {
  double lid_share = 0;  ///< of lids over the holes in the closed area
  bool is_flat = false;
  std::size_t open_component_count = 0;
};

Extent measure(const TriangleMesh& mesh, SurfaceTriage& triage) {
  const Box box = bounding_box(mesh.vertices);
  triage.vertex_count = mesh.vertices.size();
  triage.triangle_count = mesh.triangles.size();
  triage.box_min = box.low;
  triage.box_max = box.high;
  triage.area_m2 = surface_area(mesh);
  triage.volume_m3 = signed_volume(mesh);
  const double diagonal = norm(subtract(box.high, box.low));
  double lids = 0, longest = 0;
  for (const BoundaryLoop& loop : find_boundary_loops(mesh)) {
    ++triage.hole_count;
    lids += loop.lid_area_m2;
    longest = std::max(longest, loop.perimeter_m);
  }
  triage.largest_hole = diagonal > 0 ? longest / diagonal : 0;
  Extent extent;
  extent.lid_share = lids > 0 ? lids / (lids + triage.area_m2) : 0;
  extent.is_flat = is_flat(mesh.vertices);
  return extent;
}

void count_topology(const TriangleMesh& mesh, SurfaceTriage& triage) {
  const SurfaceTopology topology = measure_topology(mesh.triangles, mesh.vertices.size());
  triage.component_count = topology.shell_count;
  triage.boundary_edge_count = topology.boundary_edge_count;
  triage.nonmanifold_edge_count = topology.nonmanifold_edge_count;
  triage.nonmanifold_vertex_count = topology.nonmanifold_vertex_count;
  triage.opposed_edge_count = topology.opposed_edge_count;
}

void count_shells(const TriangleMesh& mesh, const std::vector<TrianglePair>& cuts,
                  SurfaceTriage& triage, Extent& extent) {
  for (const Shell& shell : split_into_shells(mesh, cuts)) {
    if (shell.closed && shell.depth > 0) ++triage.nested_shell_count;
    if (shell.faces_wrong()) ++triage.inverted_shell_count;
    if (!shell.closed) ++extent.open_component_count;
  }
}

SurfaceGrade grade(const SurfaceTriage& t, const Extent& extent) {
  const auto triangles = static_cast<double>(t.triangle_count);
  const auto share = [&](std::size_t count) { return static_cast<double>(count) / triangles; };
  if (extent.is_flat || !(t.area_m2 > 0)) return SurfaceGrade::hopeless;
  const bool is_jumble = share(t.self_intersection_count) > jumble_pairs_per_triangle;
  if (t.component_count == extent.open_component_count && (t.component_count == 1 || is_jumble) &&
      extent.lid_share > patch_lid_share)
    return SurfaceGrade::hopeless;
  const bool is_half_open =
      t.component_count > 1 && 2 * extent.open_component_count > t.component_count;
  if (extent.lid_share > large_lid_share || is_half_open || t.self_intersections_capped ||
      share(t.self_intersection_count) > heavy_intersection_share ||
      share(t.nonmanifold_edge_count) > heavy_nonmanifold_share)
    return SurfaceGrade::wrap;
  const std::size_t flaws = t.boundary_edge_count + t.nonmanifold_edge_count +
                            t.nonmanifold_vertex_count + t.opposed_edge_count +
                            t.degenerate_triangle_count + t.duplicate_triangle_count +
                            t.self_intersection_count + t.inverted_shell_count;
  return flaws == 0 ? SurfaceGrade::good : SurfaceGrade::repairable;
}

/// "1 boundary edge", "2 boundary edges", "3 vertices".
std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return std::to_string(count) + " " + std::string(count == 1 ? one : many);
}

std::string percent(double share) { return std::to_string(static_cast<int>(100 * share + 0.5)) + " %"; }

/// Worst first.
std::vector<std::string> describe(const SurfaceTriage& t, const Extent& extent) {
  std::vector<std::string> findings;
  const auto add_count = [&](std::size_t count, std::string_view one, std::string_view many) {
    if (count > 0) findings.push_back(counted(count, one, many));
  };
  if (extent.is_flat)
    findings.emplace_back("all vertices lie in one plane: nothing is enclosed");
  else if (t.grade == SurfaceGrade::hopeless)
    findings.push_back(
        std::string(t.component_count == 1 ? "an open patch" : "a jumble of open patches") +
        ": lids on its holes would be " + percent(extent.lid_share) + " of the closed area");
  if (t.self_intersections_capped)
    findings.push_back("more than " + std::to_string(t.self_intersection_count) +
                       " pairs of triangles cut each other");
  else
    add_count(t.self_intersection_count, "pair of triangles cuts each other",
              "pairs of triangles cut each other");
  add_count(t.nonmanifold_edge_count, "edge of more than two triangles",
            "edges of more than two triangles");
  if (t.boundary_edge_count > 0)
    findings.push_back(counted(t.boundary_edge_count, "boundary edge", "boundary edges") + " around " +
                       counted(t.hole_count, "hole", "holes") + ", " + percent(extent.lid_share) +
                       " of the closed area");
  add_count(t.nonmanifold_vertex_count, "vertex joins several fans of triangles",
            "vertices join several fans of triangles");
  add_count(t.opposed_edge_count, "edge between triangles of opposite orientation",
            "edges between triangles of opposite orientation");
  add_count(t.inverted_shell_count, "closed shell faces the wrong way",
            "closed shells face the wrong way");
  add_count(t.duplicate_triangle_count, "triangle stands there again", "triangles stand there again");
  add_count(t.degenerate_triangle_count, "triangle has no area", "triangles have no area");
  if (t.component_count > 1) add_count(t.component_count, "piece", "separate pieces");
  add_count(t.nested_shell_count, "closed shell lies inside another one",
            "closed shells lie inside another one");
  return findings;
}

}  // namespace

std::string_view surface_grade_name(SurfaceGrade grade) {
  static constexpr std::array<std::string_view, 4> names{"good", "repairable", "wrap", "hopeless"};
  return names[static_cast<std::size_t>(grade)];
}

Result<SurfaceTriage> triage_surface(const TriangleMesh& surface) try {
  if (const Status valid = check_soup(surface); !valid) return valid.issue();
  SurfaceTriage triage;
  const TriangleMesh mesh = clean_soup(surface).mesh;
  count_dropped(surface, mesh, triage);
  Extent extent = measure(mesh, triage);
  count_topology(mesh, triage);
  const SelfIntersections cuts = find_self_intersections(mesh);
  triage.self_intersection_count = cuts.pairs.size();
  triage.self_intersections_capped = cuts.capped;
  count_shells(mesh, cuts.pairs, triage, extent);
  triage.grade = grade(triage, extent);
  triage.findings = describe(triage, extent);
  return triage;
} catch (const std::exception& e) {
  return make_issue(IssueCode::surface_invalid,
                    std::string("the surface cannot be examined: ") + e.what());
}

}  // namespace souple
