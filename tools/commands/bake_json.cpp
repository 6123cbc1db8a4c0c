// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/bake_json.hpp"

namespace souple {
namespace {

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

Json orient_json(const OrientReport& r) {
  return {{"shell_count", r.shell_count},
          {"turned_triangle_count", r.turned_triangle_count},
          {"split_vertex_count", r.split_vertex_count},
          {"self_intersection_count", r.self_intersection_count},
          {"volume_m3", r.volume_m3}};
}

Json decimate_json(const DecimateReport& r) {
  return {{"face_count_before", r.face_count_before},
          {"face_count_after", r.face_count_after},
          {"volume_before_m3", r.volume_before_m3},
          {"volume_after_m3", r.volume_after_m3},
          {"hausdorff_m", r.hausdorff_m}};
}

Json quality_json(const TetQuality& q) {
  return {{"min_dihedral_deg", q.min_dihedral_deg},
          {"median_dihedral_deg", q.median_dihedral_deg},
          {"worst_radius_ratio", q.worst_radius_ratio},
          {"volume_m3", q.volume_m3}};
}

Json levels_json(const std::vector<NestedLevelReport>& reports) {
  Json levels = Json::array();
  for (const NestedLevelReport& r : reports)
    levels.push_back({{"node_count", r.node_count},
                      {"tet_count", r.tet_count},
                      {"min_dihedral_deg", r.min_dihedral_deg},
                      {"hausdorff_m", r.hausdorff_m},
                      {"rms_distance_m", r.rms_distance_m},
                      {"held_back_count", r.held_back_count}});
  return levels;
}

Json fixed_sets_json(const Asset& asset) {
  Json sets = Json::array();
  for (const FixedSet& set : asset.fixed_sets)
    sets.push_back({{"name", set.name}, {"node_count", set.nodes.size()}});
  return sets;
}

Json times_json(const BakeReport& r) {
  Json stages = Json::array();
  double total = 0;
  for (const StageTime& stage : r.stages) {
    stages.push_back({{"stage", stage.name}, {"wall_s", stage.wall_s}});
    total += stage.wall_s;
  }
  return {{"total_s", total}, {"stages", stages}};
}

}  // namespace

Json bake_json(const BakeOutcome& outcome, const Recipe& recipe, const std::string& asset_file) {
  const BakeReport& r = outcome.report;
  Json document = schema_header("bake");
  document["asset"] = asset_file;
  document["asset_bytes"] = r.asset_bytes;
  document["content_hash"] = r.content_hash;
  document["recipe"] = canonical_recipe_text(recipe);
  document["times"] = times_json(r);
  document["peak_memory_bytes"] = r.peak_memory_bytes;
  document["import"] = import_json(r.import);
  document["orient"] = orient_json(r.orient);
  document["decimate"] = decimate_json(r.decimate);
  document["coarse_mesh"] = {{"node_count", r.coarse.node_count},
                             {"tet_count", r.coarse.tet_count},
                             {"attempts", r.coarse.attempts},
                             {"quality", quality_json(r.coarse.quality)}};
  document["levels"] = levels_json(r.levels);
  document["finest_quality"] = quality_json(r.finest_quality);
  document["box_m"] = {{"min", r.box_min}, {"max", r.box_max}};
  document["longest_side_m"] = r.longest_side_m;
  document["sag_ratio"] = r.sag_ratio;
  document["wave_ratio"] = r.wave_ratio;
  document["fixed_sets"] = fixed_sets_json(outcome.asset);
  document["compliances"] = Json::array();
  for (const auto& variant : outcome.asset.compliances)
    document["compliances"].push_back(compliance_json(variant.header));
  document["groups"] = group_costs_json(r.groups);
  document["notes"] = r.notes;
  return document;
}

}  // namespace souple
