// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/bake_json.hpp"

#include "tools/commands/mesh_json.hpp"

namespace souple {
namespace {

Json regions_json(const std::vector<RegionReport>& reports) {
  Json regions = Json::array();
  for (const RegionReport& r : reports)
    regions.push_back(
        {{"name", r.name},
         {"tet_count", r.tet_count},
         {"volume_m3", r.volume_m3},
         {"wanted_volume_m3", r.wanted_volume_m3 < 0 ? Json() : Json(r.wanted_volume_m3)}});
  return regions;
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

Json bake_json(const BakeOutcome& outcome, const std::string& asset_file) {
  const BakeReport& r = outcome.report;
  Json document = schema_header("bake");
  document["asset"] = asset_file;
  document["asset_bytes"] = r.asset_bytes;
  document["content_hash"] = r.content_hash;
  document["recipe"] = outcome.asset.provenance.recipe;
  document["times"] = times_json(r);
  document["peak_memory_bytes"] = r.peak_memory_bytes;
  document.update(body_mesh_json(r.mesh));
  document["regions"] = regions_json(r.regions);
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
