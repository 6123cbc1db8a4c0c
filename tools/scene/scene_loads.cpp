// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/scene_loads.hpp"

#include <algorithm>
#include <limits>

#include "runtime/collision/triangle_distance.hpp"
#include "runtime/world/soft_body_asset.hpp"

namespace souple {
namespace {

bool is_inside(const Point& p, const LoadPlace::Box& box) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (p[axis] < box.min[axis] || p[axis] > box.max[axis]) return false;
  return true;
}

/// By node, whether the place holds it. Issue load_invalid: the asset has no such set.
Result<std::vector<char>> selected_nodes(const LoadPlace& place, const SoftBodyAsset& asset,
                                         const std::string& where) {
  const auto rest = asset.model().rest_positions();
  std::vector<char> selected(rest.size(), place.set.empty() && !place.box ? 1 : 0);
  if (!place.set.empty()) {
    const FixedSet* set = asset.find_fixed_set(place.set);
    if (set == nullptr)
      return make_issue(IssueCode::load_invalid, "the asset has no set \"" + place.set + "\"", where);
    for (const Index node : set->nodes) selected[static_cast<std::size_t>(node)] = 1;
  }
  if (place.box)
    for (std::size_t node = 0; node < rest.size(); ++node)
      selected[node] = is_inside(rest[node], *place.box) ? 1 : 0;
  return selected;
}

void aim_at_point(LoadDescription& load, const Point& point, const SoftBodyAsset& asset) {
  const auto rest = asset.model().rest_positions();
  const auto triangles = asset.surface().triangles();
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto corner = [&](std::size_t k) {
      return Vec3(as_vec3(rest[static_cast<std::size_t>(triangles[t][k])]));
    };
    const auto closest = closest_on_triangle(as_vec3(point), corner(0), corner(1), corner(2));
    const double distance = (closest.point - as_vec3(point)).norm();
    if (!(distance < nearest)) continue;
    nearest = distance;
    load.triangle = static_cast<Index>(t);
    load.weight = closest.weight;
  }
}

}  // namespace

Result<LoadDescription> place_load(const SceneLoad& scene_load, const SoftBodyAsset& asset,
                                   const std::string& body) {
  LoadDescription load = scene_load.load;
  const std::string where = body + ": " + load.name;
  load.name = where;
  if (load.kind == LoadKind::point_force) {
    aim_at_point(load, *scene_load.place.point, asset);
    return load;
  }
  const auto selected = selected_nodes(scene_load.place, asset, where);
  if (!selected) return selected.issue();
  const auto is_selected = [&](Index node) { return (*selected)[static_cast<std::size_t>(node)] != 0; };
  if (load.kind == LoadKind::node_force) {
    for (std::size_t node = 0; node < selected->size(); ++node)
      if ((*selected)[node] != 0) load.nodes.push_back(static_cast<Index>(node));
    if (load.nodes.empty()) return make_issue(IssueCode::load_invalid, "no node is selected", where);
    return load;
  }
  const auto triangles = asset.surface().triangles();
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (std::ranges::all_of(triangles[t], is_selected)) load.triangles.push_back(static_cast<Index>(t));
  if (load.triangles.empty())
    return make_issue(IssueCode::load_invalid, "no boundary triangle is selected", where);
  return load;
}

}  // namespace souple
