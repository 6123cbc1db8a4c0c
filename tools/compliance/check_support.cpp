// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/check_support.hpp"

#include <Eigen/Geometry>
#include <numeric>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {
namespace {

// Sine of the smallest angle between fixed nodes that still counts as "not on one line".
constexpr double collinear_sine = 1e-6;

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  Index root(Index i) {
    while (parent_[std::size_t(i)] != i)
      i = parent_[std::size_t(i)] = parent_[std::size_t(parent_[std::size_t(i)])];
    return i;
  }
  void join(Index a, Index b) { parent_[std::size_t(root(b))] = root(a); }

 private:
  std::vector<Index> parent_;
};

bool spans_a_plane(const std::vector<Vec3>& points) {
  for (std::size_t k = 1; k < points.size(); ++k) {
    // The farthest point from the first gives the line.
    const Vec3 line = points[k] - points[0];
    if (line.norm() == 0) continue;
    for (std::size_t other = k + 1; other < points.size(); ++other) {
      const Vec3 to = points[other] - points[0];
      if (line.cross(to).norm() > collinear_sine * line.norm() * to.norm()) return true;
    }
    return false;  // all others are on the line through points 0 and k
  }
  return false;
}

}  // namespace

Status check_fixed_set(const FixedSet& fixed, std::size_t node_count) {
  const auto refuse = [&](const std::string& what) {
    return Status(make_issue(IssueCode::fixed_set_invalid, what, "fixed set \"" + fixed.name + "\""));
  };
  if (fixed.nodes.empty()) return refuse("it selects no node");
  if (fixed.nodes.size() >= node_count) return refuse("it selects every node");
  for (std::size_t k = 0; k < fixed.nodes.size(); ++k)
    if (fixed.nodes[k] < 0 || std::size_t(fixed.nodes[k]) >= node_count ||
        (k > 0 && fixed.nodes[k] <= fixed.nodes[k - 1]))
      return refuse("its node indices do not ascend within the mesh");
  return {};
}

Status check_static_support(const TetMesh& mesh, const FixedSet* fixed) {
  DisjointSets parts(mesh.nodes.size());
  for (const auto& tet : mesh.tets)
    for (int k = 1; k < 4; ++k) parts.join(tet[0], tet[std::size_t(k)]);
  std::vector<std::vector<Vec3>> held(mesh.nodes.size());
  if (fixed)
    for (const Index node : fixed->nodes)
      held[std::size_t(parts.root(node))].push_back(as_vec3(mesh.nodes[std::size_t(node)]));
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node)
    if (parts.root(Index(node)) == Index(node) && !spans_a_plane(held[node]))
      return make_issue(
          IssueCode::compliance_singular,
          "the part of the mesh that holds node " + std::to_string(node) + " can move freely",
          fixed ? "fixed set \"" + fixed->name + "\"" : "no fixed set");
  return {};
}

}  // namespace souple
