// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/mesh_json.hpp"

#include "tools/exchange/numbers.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

Json distance_json(const SurfaceDistance& d) {
  return {{"largest_m", d.largest}, {"rms_m", d.root_mean_square}};
}

/// `of_input`: samples of what came in, measured from what goes out.
Json two_sided_json(const TwoSidedDistance& d) {
  return {{"forth", distance_json(d.forth)},
          {"back", distance_json(d.back)},
          {"hausdorff_m", d.hausdorff()},
          {"rms_m", d.root_mean_square()}};
}

std::string_view mesher_name(MesherKind kind) {
  return kind == MesherKind::lattice ? "lattice" : "delaunay";
}

Json level_json(const LevelReport& r) {
  return {{"node_count", r.node_count},
          {"tet_count", r.tet_count},
          {"min_dihedral_deg", r.min_dihedral_deg},
          {"worst_radius_ratio", r.worst_radius_ratio},
          {"worst_aspect", r.worst_aspect},
          {"distance", two_sided_json(r.distance)},
          {"held_back_count", r.held_back_count},
          {"children",
           {{"share_keeping_70", r.children.share_keeping_70}, {"worst_kept", r.children.worst_kept}}},
          {"rigid_motion_error",
           {{"parents", r.rigid_motion_error.parents}, {"embedding", r.rigid_motion_error.embedding}}}};
}

template <class Report, class ToJson>
Json or_null(const std::optional<Report>& report, const ToJson& to_json) {
  return report ? to_json(*report) : Json();
}

Json visual_json(const VisualReport& r) {
  return {{"vertex_count", r.vertex_count},
          {"outside_count", r.outside_count},
          {"farthest_outside_m", r.farthest_outside_m},
          {"largest_weight", r.largest_weight}};
}

std::string metres(double value) { return rounded_text(value, 3) + " m"; }

}  // namespace

Json import_json(const ImportReport& r) {
  return {{"format", r.format},
          {"file_bytes", r.file_bytes},
          {"file_hash", r.file_hash},
          {"raw_vertex_count", r.raw_vertex_count},
          {"merged_vertex_count", r.merged_vertex_count},
          {"raw_polygon_count", r.raw_polygon_count},
          {"dropped_triangle_count", r.dropped_triangle_count},
          {"scale", r.scale}};
}

Json import_tets_json(const ImportTetsReport& r) {
  return {{"format", r.format},
          {"file_bytes", r.file_bytes},
          {"file_hash", r.file_hash},
          {"raw_node_count", r.raw_node_count},
          {"raw_tet_count", r.raw_tet_count},
          {"unused_node_count", r.unused_node_count},
          {"other_element_count", r.other_element_count},
          {"linearised_count", r.linearised_count},
          {"turned_count", r.turned_count},
          {"dropped_count", r.dropped_count},
          {"scale", r.scale}};
}

Json triage_json(const SurfaceTriage& t) {
  return {{"grade", surface_grade_name(t.grade)},
          {"findings", t.findings},
          {"vertex_count", t.vertex_count},
          {"triangle_count", t.triangle_count},
          {"component_count", t.component_count},
          {"nested_shell_count", t.nested_shell_count},
          {"inverted_shell_count", t.inverted_shell_count},
          {"boundary_edge_count", t.boundary_edge_count},
          {"hole_count", t.hole_count},
          {"largest_hole", t.largest_hole},
          {"nonmanifold_edge_count", t.nonmanifold_edge_count},
          {"nonmanifold_vertex_count", t.nonmanifold_vertex_count},
          {"opposed_edge_count", t.opposed_edge_count},
          {"degenerate_triangle_count", t.degenerate_triangle_count},
          {"duplicate_triangle_count", t.duplicate_triangle_count},
          {"self_intersection_count", t.self_intersection_count},
          {"self_intersections_capped", t.self_intersections_capped},
          {"box_m", {{"min", t.box_min}, {"max", t.box_max}}},
          {"area_m2", t.area_m2},
          {"volume_m3", t.volume_m3}};
}

Json repair_json(const RepairReport& r) {
  Json actions = Json::array();
  for (const RepairAction& action : r.actions)
    actions.push_back({{"name", action.name}, {"count", action.count}, {"detail", action.detail}});
  return {{"before", triage_json(r.before)},
          {"after", triage_json(r.after)},
          {"actions", actions},
          {"wrapped", r.wrapped},
          {"shell_count", r.orient.shell_count},
          {"turned_triangle_count", r.orient.turned_triangle_count},
          {"split_vertex_count", r.orient.split_vertex_count},
          {"volume_m3", r.orient.volume_m3},
          {"moved", two_sided_json(r.moved)}};
}

Json decimate_json(const DecimateReport& r) {
  return {{"face_count_before", r.face_count_before},
          {"face_count_after", r.face_count_after},
          {"volume_before_m3", r.volume_before_m3},
          {"volume_after_m3", r.volume_after_m3},
          {"hausdorff_m", r.hausdorff_m},
          {"self_intersection_count", r.self_intersection_count},
          {"notes", r.notes}};
}

Json quality_json(const TetQuality& q) {
  return {{"min_dihedral_deg", q.min_dihedral_deg},
          {"median_dihedral_deg", q.median_dihedral_deg},
          {"worst_radius_ratio", q.worst_radius_ratio},
          {"worst_aspect", q.worst_aspect},
          {"volume_m3", q.volume_m3}};
}

Json tetrahedralize_json(const TetrahedralizeReport& r) {
  return {{"node_count", r.node_count},
          {"tet_count", r.tet_count},
          {"attempts", r.attempts},
          {"mesher", mesher_name(r.mesher)},
          {"features",
           {{"kept", r.features.kept},
            {"sharp_edge_count", r.features.sharp_edge_count},
            {"sharp_length_share", r.features.sharp_length_share},
            {"reason", r.features.reason}}},
          {"quality", quality_json(r.quality)},
          {"notes", r.notes}};
}

Json levels_json(const std::vector<LevelReport>& reports) {
  Json levels = Json::array();
  for (const LevelReport& r : reports) levels.push_back(level_json(r));
  return levels;
}

Json body_mesh_json(const BodyMeshReport& r) {
  return {{"import", or_null(r.import, import_json)},
          {"import_tets", or_null(r.import_tets, import_tets_json)},
          {"repair", or_null(r.repair, repair_json)},
          {"decimate", or_null(r.decimate, decimate_json)},
          {"coarse_mesh", or_null(r.coarse, tetrahedralize_json)},
          {"levels", levels_json(r.levels)},
          {"visual", or_null(r.visual, visual_json)}};
}

std::string triage_text(const SurfaceTriage& t) {
  std::string text = "grade " + std::string(surface_grade_name(t.grade)) + ": " +
                     std::to_string(t.triangle_count) + " triangles, " +
                     std::to_string(t.component_count) + " components, longest side " +
                     metres(longest_side({t.box_min, t.box_max})) + "\n";
  for (const std::string& finding : t.findings) text += "  " + finding + "\n";
  return text;
}

std::string repair_text(const RepairReport& r) {
  std::string text;
  for (const RepairAction& action : r.actions)
    text += "  " + action.name + (action.count > 0 ? " " + std::to_string(action.count) : "") +
            (action.detail.empty() ? "" : ": " + action.detail) + "\n";
  const double diagonal = norm(subtract(r.before.box_max, r.before.box_min));
  return text + "  the surface moved " + metres(r.moved.hausdorff()) + " at most (" +
         rounded_text(100 * r.moved.hausdorff() / diagonal, 2) + " % of the diagonal), volume " +
         rounded_text(r.orient.volume_m3, 4) + " m^3\n";
}

std::string levels_text(const std::vector<LevelReport>& reports) {
  std::string text;
  for (std::size_t l = 0; l < reports.size(); ++l) {
    const LevelReport& r = reports[l];
    text += "level " + std::to_string(l) + ": " + std::to_string(r.node_count) + " nodes, " +
            std::to_string(r.tet_count) + " tets, smallest dihedral angle " +
            rounded_text(r.min_dihedral_deg, 3) + " deg, from the surface " +
            metres(r.distance.hausdorff()) + " at most, " + metres(r.distance.root_mean_square()) +
            " rms\n";
  }
  return text;
}

}  // namespace souple
