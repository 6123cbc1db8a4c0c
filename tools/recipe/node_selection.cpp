// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/node_selection.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tools/exchange/numbers.hpp"
#include "tools/geometry/surface_measure.hpp"

namespace souple {
namespace {

double squared_distance(const Point& a, const Point& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

bool selects(const BoxSelection& box, const Point& x) {
  for (std::size_t i = 0; i < 3; ++i)
    if (x[i] < box.min[i] || x[i] > box.max[i]) return false;
  return true;
}

bool selects(const SphereSelection& sphere, const Point& x) {
  return squared_distance(x, sphere.centre) <= sphere.radius_m * sphere.radius_m;
}

bool selects(const PlaneSelection& plane, const Point& x) {
  const auto& n = plane.normal;
  double height = 0;
  for (std::size_t i = 0; i < 3; ++i) height += n[i] * (x[i] - plane.point[i]);
  return height <= plane.distance_m * std::hypot(n[0], n[1], n[2]);
}

template <class Selection>
std::vector<Index> nodes_of(const Selection& selection, const std::vector<Point>& nodes) {
  std::vector<Index> selected;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (selects(selection, nodes[i])) selected.push_back(static_cast<Index>(i));
  return selected;
}

std::vector<Index> nodes_of(const NearestSelection& nearest, const std::vector<Point>& nodes) {
  std::vector<Index> order(nodes.size());
  std::iota(order.begin(), order.end(), 0);
  const auto count = std::min(static_cast<std::size_t>(nearest.count), nodes.size());
  const auto nearer = [&](Index a, Index b) {
    const double da = squared_distance(nodes[static_cast<std::size_t>(a)], nearest.point);
    const double db = squared_distance(nodes[static_cast<std::size_t>(b)], nearest.point);
    return da != db ? da < db : a < b;
  };
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                    nearer);
  order.resize(count);
  std::ranges::sort(order);
  return order;
}

std::vector<Index> selected_nodes(const NodeSelection& selection, const std::vector<Point>& nodes) {
  return std::visit([&](const auto& kind) { return nodes_of(kind, nodes); }, selection);
}

std::string point_text(const Point& p) {
  return "[" + rounded_text(p[0]) + ", " + rounded_text(p[1]) + ", " + rounded_text(p[2]) + "]";
}

}  // namespace

Result<FixedSet> select_nodes(const FixedRequest& request, const std::vector<Point>& nodes) {
  FixedSet set;
  set.name = request.name;
  set.nodes = selected_nodes(request.selection, nodes);
  if (!set.nodes.empty() && set.nodes.size() < nodes.size()) return set;
  return make_issue(IssueCode::fixed_set_invalid,
                    std::string("the selection holds ") + (set.nodes.empty() ? "none" : "all") +
                        " of the " + std::to_string(nodes.size()) + " nodes",
                    "[[fixed]] " + request.name,
                    "Select with respect to the final mesh, which spans " + span_text(nodes) + ".");
}

Result<std::vector<Index>> select_region(const NodeSelection& selection,
                                         const std::vector<Point>& nodes, const std::string& where) {
  auto selected = selected_nodes(selection, nodes);
  if (!selected.empty()) return selected;
  return make_issue(IssueCode::compliance_region_empty,
                    "the selection holds none of the " + std::to_string(nodes.size()) + " nodes", where,
                    "Select with respect to the final mesh, which spans " + span_text(nodes) + ".");
}

std::string span_text(const std::vector<Point>& points) {
  const Box box = bounding_box(points);
  return point_text(box.low) + " .. " + point_text(box.high) + " m";
}

}  // namespace souple
