// SPDX-License-Identifier: MIT
#include "runtime/world/applied_load.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/world/soft_body_asset.hpp"

namespace souple {
namespace {

constexpr double largest_value = 1e12;  // N or Pa: no sum of them overflows

Issue refuse(const std::string& what, const std::string& where) {
  return make_issue(IssueCode::load_invalid, what, where);
}

Status check_value(const LoadKeyframe& value, const std::string& where) {
  for (const double c : value.vector)
    if (!(std::abs(c) <= largest_value))
      return refuse("the value " + std::to_string(c) + " is not finite or above 1e12", where);
  if (!(std::abs(value.pressure_pa) <= largest_value))
    return refuse("the pressure " + std::to_string(value.pressure_pa) + " Pa is out of range", where);
  return {};
}

Status check_course(const std::vector<LoadKeyframe>& course, const std::string& where) {
  if (course.empty()) return refuse("a load needs a value", where);
  for (std::size_t k = 0; k < course.size(); ++k) {
    if (auto status = check_value(course[k], where); !status) return status;
    if (!std::isfinite(course[k].time_s) || (k > 0 && !(course[k].time_s > course[k - 1].time_s)))
      return refuse("the times of the load do not ascend", where);
  }
  return {};
}

Status check_indices(std::span<const Index> indices, std::size_t count, const char* what,
                     const std::string& where) {
  for (const Index index : indices)
    if (index < 0 || std::size_t(index) >= count)
      return refuse(std::string(what) + " " + std::to_string(index) + " of " + std::to_string(count) +
                        " does not exist",
                    where);
  return {};
}

Status check_place(const LoadDescription& d, const SoftBodyAsset& asset) {
  const std::size_t triangle_count = asset.surface().triangles().size();
  switch (d.kind) {
    case LoadKind::node_force:
      if (d.nodes.empty()) return refuse("a force needs at least one node", d.name);
      return check_indices(d.nodes, std::size_t(asset.model().node_count()), "node", d.name);
    case LoadKind::point_force: {
      const double sum = d.weight[0] + d.weight[1] + d.weight[2];
      if (!(std::abs(sum - 1) < 1e-6) ||
          !std::ranges::all_of(d.weight, [](double w) { return w >= -1e-6 && w <= 1 + 1e-6; }))
        return refuse("the weights are not barycentric", d.name);
      return check_indices({&d.triangle, 1}, triangle_count, "boundary triangle", d.name);
    }
    case LoadKind::traction:
    case LoadKind::pressure:
      return check_indices(d.triangles, triangle_count, "boundary triangle", d.name);
  }
  return {};
}

// Outward, its length twice the area.
Vec3 area2(const Triangle& t, const Eigen::VectorXd& x) {
  const Vec3 origin = node_entry(x, t[0]);
  return (node_entry(x, t[1]) - origin).cross(node_entry(x, t[2]) - origin);
}

double rest_area(const Triangle& t, std::span<const Point> rest) {
  const Vec3 origin = as_vec3(rest[std::size_t(t[0])]);
  return 0.5 * (as_vec3(rest[std::size_t(t[1])]) - origin)
                   .cross(as_vec3(rest[std::size_t(t[2])]) - origin)
                   .norm();
}

}  // namespace

Result<AppliedLoad> AppliedLoad::create(const LoadDescription& d, const SoftBodyAsset& asset,
                                        const Eigen::VectorXd& x) {
  if (auto status = check_course(d.course, d.name); !status) return status.issue();
  if (auto status = check_place(d, asset); !status) return status.issue();
  AppliedLoad load;
  load.kind_ = d.kind;
  load.follows_ = d.follows;
  load.course_ = d.course;
  if (d.kind == LoadKind::node_force || d.kind == LoadKind::point_force) {
    load.weigh_nodes(d, asset);
    return load;
  }
  std::vector<Index> triangles = d.triangles;
  if (triangles.empty())
    for (std::size_t t = 0; t < asset.surface().triangles().size(); ++t)
      triangles.push_back(static_cast<Index>(t));
  if (d.kind == LoadKind::pressure && d.follows)
    for (const Index t : triangles)
      load.triangles_.push_back(asset.surface().triangles()[std::size_t(t)]);
  else
    load.weigh_areas(triangles, asset, x);
  return load;
}

void AppliedLoad::weigh_nodes(const LoadDescription& d, const SoftBodyAsset& asset) {
  if (d.kind == LoadKind::node_force) {
    nodes_ = d.nodes;
    weights_.assign(nodes_.size(), 1.0 / double(nodes_.size()));
    return;
  }
  const Triangle& corners = asset.surface().triangles()[std::size_t(d.triangle)];
  nodes_.assign(corners.begin(), corners.end());
  weights_.assign(d.weight.begin(), d.weight.end());
}

// A third of a triangle's area to each of its corners.
void AppliedLoad::weigh_areas(std::span<const Index> triangles, const SoftBodyAsset& asset,
                              const Eigen::VectorXd& x) {
  const auto node_count = std::size_t(asset.model().node_count());
  std::vector<double> areas(node_count, 0.0);
  std::vector<Vec3> normals(node_count, Vec3::Zero());
  for (const Index index : triangles) {
    const Triangle& t = asset.surface().triangles()[std::size_t(index)];
    const double third = rest_area(t, asset.model().rest_positions()) / 3;
    for (const Index node : t) {
      areas[std::size_t(node)] += third;
      normals[std::size_t(node)] += area2(t, x) / 6;
    }
  }
  for (std::size_t node = 0; node < node_count; ++node) {
    if (areas[node] == 0) continue;
    nodes_.push_back(static_cast<Index>(node));
    weights_.push_back(areas[node]);
    areas_.push_back(normals[node]);
  }
}

Status AppliedLoad::set(const LoadKeyframe& value, const std::string& where) {
  if (auto status = check_value(value, where); !status) return status;
  course_.resize(1);
  course_.front() = value;
  return {};
}

LoadKeyframe AppliedLoad::at(double time_s) const {
  const auto after = std::ranges::upper_bound(course_, time_s, {}, &LoadKeyframe::time_s);
  if (after == course_.begin()) return course_.front();
  if (after == course_.end()) return course_.back();
  const LoadKeyframe &from = *(after - 1), &to = *after;
  const double share = (time_s - from.time_s) / (to.time_s - from.time_s);
  const Vec3 vector = (1 - share) * as_vec3(from.vector) + share * as_vec3(to.vector);
  return {time_s, as_point(vector), (1 - share) * from.pressure_pa + share * to.pressure_pa};
}

void AppliedLoad::add_to(Eigen::VectorXd& forces, double time_s, const Eigen::VectorXd& x,
                         std::span<const Mat3> node_rotations) const {
  const LoadKeyframe value = at(time_s);
  if (kind_ == LoadKind::pressure && follows_)
    return add_present_pressure(forces, value.pressure_pa, x);
  if (kind_ == LoadKind::pressure) {
    for (std::size_t k = 0; k < nodes_.size(); ++k)
      node_entry(forces, nodes_[k]) -= value.pressure_pa * areas_[k];
    return;
  }
  const Vec3 vector = as_vec3(value.vector);
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const Vec3 force = weights_[k] * vector;
    node_entry(forces, nodes_[k]) +=
        follows_ ? Vec3(node_rotations[std::size_t(nodes_[k])] * force) : force;
  }
}

void AppliedLoad::add_present_pressure(Eigen::VectorXd& forces, double pressure_pa,
                                       const Eigen::VectorXd& x) const {
  for (const Triangle& t : triangles_) {
    const Vec3 share = (-pressure_pa / 6) * area2(t, x);
    for (const Index node : t) node_entry(forces, node) += share;
  }
}

}  // namespace souple
