// SPDX-License-Identifier: MIT
#include "runtime/collision/rigid_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace souple {
namespace {

constexpr double largest_coordinate_m = 1e6;
constexpr std::size_t largest_count = std::size_t{1} << 28;  // features are numbered in 32 bits

Issue refuse(const std::string& what) { return make_issue(IssueCode::rigid_mesh_invalid, what, ""); }

Status check_numbers(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return refuse("the surface has no triangles");
  if (mesh.triangles.size() > largest_count || mesh.vertices.size() > largest_count)
    return refuse("the surface has more than " + std::to_string(largest_count) +
                  " triangles or vertices");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    for (const double x : mesh.vertices[v])
      if (!(std::abs(x) <= largest_coordinate_m))
        return refuse("vertex " + std::to_string(v) + " is not within 1e6 m");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    for (const Index v : corners)
      if (v < 0 || std::size_t(v) >= mesh.vertices.size())
        return refuse("triangle " + std::to_string(t) + " names vertex " + std::to_string(v) + " of " +
                      std::to_string(mesh.vertices.size()));
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
      return refuse("triangle " + std::to_string(t) + " names a vertex twice");
  }
  return {};
}

Status check_closed(const CollisionTopology& topology) {
  const auto ends = [&](const CollisionTopology::Edge& e) {
    return "the edge between vertices " + std::to_string(topology.nodes[e.vertex[0]]) + " and " +
           std::to_string(topology.nodes[e.vertex[1]]);
  };
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    const auto& edge = topology.edges[e];
    if (edge.triangle[1] < 0)
      return refuse(ends(edge) + " does not have one triangle on each side, wound alike");
    if (e > 0 && topology.edges[e - 1].vertex == edge.vertex)
      return refuse(ends(edge) + " has more than two triangles");
  }
  return {};
}

}  // namespace

RigidMesh::RigidMesh(TriangleMesh mesh, const MassProperties& mass)
    : mesh_(std::move(mesh)), tree_(mesh_.vertices, mesh_.triangles), mass_(mass) {}

Result<RigidMesh> RigidMesh::make(TriangleMesh mesh) {
  if (auto status = check_numbers(mesh); !status) return status.issue();
  const MassProperties mass = mass_properties(mesh.vertices, mesh.triangles);
  RigidMesh made(std::move(mesh), mass);
  if (auto status = check_closed(made.tree_.topology()); !status) return status.issue();
  const Eigen::Vector3d inertia = mass.inertia.diagonal();
  if (!(mass.volume > 0) || !(inertia.minCoeff() > 0))
    return refuse("its volume is " + std::to_string(mass.volume) + " m3: it is wound inward or flat");
  return made;
}

std::size_t RigidMesh::bytes() const {
  return tree_.bytes() + mesh_.vertices.size() * sizeof(Point) +
         mesh_.triangles.size() * sizeof(Triangle);
}

PlacedMesh::PlacedMesh(const RigidMesh& mesh)
    : mesh_(&mesh), x_(3 * Eigen::Index(mesh.vertices().size())), surface_(mesh.tree()) {}

void PlacedMesh::move_to(const RigidPlacement& at) {
  if (placed_ && at.rotation == at_.rotation && at.translation == at_.translation) return;
  at_ = at;
  placed_ = true;
  positions_at(at, x_);
  surface_.refit(x_);
}

void PlacedMesh::positions_at(const RigidPlacement& at, Eigen::VectorXd& x) const {
  const auto vertices = mesh_->vertices();
  x.resize(3 * Eigen::Index(vertices.size()));
  for (std::size_t v = 0; v < vertices.size(); ++v)
    x.segment<3>(3 * Eigen::Index(v)) = at.rotation * as_vec3(vertices[v]) + at.translation;
}

}  // namespace souple
