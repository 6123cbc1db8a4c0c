// SPDX-License-Identifier: MIT
#include "runtime/fem/corotational_model.hpp"

#include <cmath>

namespace souple {
namespace {

Issue element_issue(std::size_t tet, const std::string& what) {
  return make_issue(IssueCode::mesh_element_invalid, "tet " + std::to_string(tet) + " " + what);
}

Status check_region(const MaterialRegion& region, std::size_t index) {
  const auto refuse = [&](const std::string& what) {
    return Status(
        make_issue(IssueCode::material_out_of_range, what, "material region " + std::to_string(index)));
  };
  if (!(std::isfinite(region.young_pa) && region.young_pa > 0))
    return refuse("Young's modulus is " + std::to_string(region.young_pa) + " Pa");
  if (!(region.poisson > -1 && region.poisson < 0.5))
    return refuse("Poisson's ratio is " + std::to_string(region.poisson));
  if (!(std::isfinite(region.density_kg_m3) && region.density_kg_m3 > 0))
    return refuse("density is " + std::to_string(region.density_kg_m3) + " kg/m3");
  return {};
}

Status check_material(const Material& material, std::size_t tet_count) {
  if (material.regions.empty())
    return make_issue(IssueCode::material_out_of_range, "the material has no region");
  for (std::size_t i = 0; i < material.regions.size(); ++i)
    if (auto status = check_region(material.regions[i], i); !status) return status;
  const auto valid_rayleigh = [](double factor) { return std::isfinite(factor) && factor >= 0; };
  if (!valid_rayleigh(material.rayleigh_mass_per_s) || !valid_rayleigh(material.rayleigh_stiffness_s))
    return make_issue(IssueCode::material_out_of_range, "a Rayleigh factor is negative or not finite");
  if (!material.tet_region.empty() && material.tet_region.size() != tet_count)
    return make_issue(IssueCode::material_out_of_range, std::to_string(material.tet_region.size()) +
                                                            " region indices for " +
                                                            std::to_string(tet_count) + " tets");
  for (const Index region : material.tet_region)
    if (region < 0 || std::size_t(region) >= material.regions.size())
      return make_issue(IssueCode::material_out_of_range,
                        "region index " + std::to_string(region) + " does not exist");
  return {};
}

Status check_tet(const TetMesh& mesh, std::size_t t) {
  for (const Index node : mesh.tets[t])
    if (node < 0 || std::size_t(node) >= mesh.nodes.size())
      return element_issue(
          t, "names node " + std::to_string(node) + " of " + std::to_string(mesh.nodes.size()));
  for (const Index node : mesh.tets[t])
    for (const double coordinate : mesh.nodes[node])
      if (!std::isfinite(coordinate)) return element_issue(t, "has a coordinate that is not finite");
  const auto& tet = mesh.tets[t];
  const double volume6 =
      signed_volume6(mesh.nodes[tet[0]], mesh.nodes[tet[1]], mesh.nodes[tet[2]], mesh.nodes[tet[3]]);
  if (!(volume6 > 0)) return element_issue(t, volume6 < 0 ? "is inverted" : "is flat");
  return {};
}

// Inverse of the matrix of edges from the first node; its determinant > 0 is checked before.
Mat3 inverse_edges(const TetMesh& mesh, const Tet& tet) {
  const Vec3 origin = as_vec3(mesh.nodes[tet[0]]);
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = as_vec3(mesh.nodes[tet[k + 1]]) - origin;
  return edges.inverse();
}

}  // namespace

Lame lame_parameters(double young_pa, double poisson) {
  return {young_pa * poisson / ((1 + poisson) * (1 - 2 * poisson)), young_pa / (2 * (1 + poisson))};
}

Result<CorotationalModel> CorotationalModel::create(const TetMesh& mesh, const Material& material) {
  if (mesh.tets.empty())
    return make_issue(IssueCode::mesh_element_invalid, "the mesh has no tetrahedra");
  if (auto status = check_material(material, mesh.tets.size()); !status) return status.issue();
  CorotationalModel model;
  model.rest_ = mesh.nodes;
  model.tets_ = mesh.tets;
  model.masses_.assign(mesh.nodes.size(), 0.0);
  model.rayleigh_mass_ = material.rayleigh_mass_per_s;
  model.rayleigh_stiffness_ = material.rayleigh_stiffness_s;
  model.elements_.reserve(mesh.tets.size());
  std::vector<double> ratio;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (auto status = check_tet(mesh, t); !status) return status.issue();
    const auto& tet = mesh.tets[t];
    const auto& region = material.regions[material.tet_region.empty() ? 0 : material.tet_region[t]];
    const double volume =
        signed_volume6(mesh.nodes[tet[0]], mesh.nodes[tet[1]], mesh.nodes[tet[2]], mesh.nodes[tet[3]]) /
        6;
    const Mat3 inverse = inverse_edges(mesh, tet);
    if (!inverse.allFinite()) return element_issue(t, "is flat to working precision");
    const Lame lame = lame_parameters(region.young_pa, region.poisson);
    model.elements_.add(tet, inverse, volume, lame);
    model.volumes_.push_back(volume);
    ratio.push_back(2 * region.poisson / (1 - 2 * region.poisson));
    for (const Index node : tet) model.masses_[node] += 0.25 * volume * region.density_kg_m3;
    model.total_mass_ += volume * region.density_kg_m3;
  }
  for (std::size_t node = 0; node < model.masses_.size(); ++node)
    if (!(model.masses_[node] > 0))
      return make_issue(IssueCode::mesh_element_invalid,
                        "node " + std::to_string(node) + " belongs to no tetrahedron");
  model.pattern_ = build_block_pattern(model.node_count(), model.tets_);
  model.nodes_ = NodeGather(model.node_count(), model.tets_);
  CornerVectors rest_gradients = model.make_corner_vectors();
  model.elements_.gradients(nullptr, model.elements_.all_packs(), rest_gradients.data());
  model.plan_ = AssemblyPlan(model.pattern_, model.tets_, rest_gradients, std::move(ratio));
  return model;
}

std::size_t CorotationalModel::bytes() const {
  return rest_.size() * sizeof(Point) + tets_.size() * sizeof(Tet) +
         (masses_.size() + volumes_.size()) * sizeof(double) +
         (pattern_.row_begin.size() + pattern_.column.size() + pattern_.diagonal.size()) *
             sizeof(Index) +
         elements_.bytes() + plan_.bytes() + nodes_.bytes();
}

void CorotationalModel::element_rotations(const Eigen::VectorXd& x, std::vector<Mat3>& rotations,
                                          RotationMethod method) const {
  rotations.resize(tets_.size());
  elements_.evaluate(x.data(), method, elements_.all_packs(), {rotations.data()});
}

void CorotationalModel::evaluate_elements(const Eigen::VectorXd& x, RotationMethod method,
                                          std::vector<Mat3>& rotations, CornerVectors& gradients,
                                          CornerVectors& corner_forces) const {
  rotations.resize(tets_.size());
  elements_.evaluate(x.data(), method, elements_.all_packs(),
                     {rotations.data(), gradients.data(), corner_forces.data()});
}

void CorotationalModel::node_rotations(const std::vector<Mat3>& element_rotations,
                                       std::vector<Mat3>& rotations) const {
  rotations.resize(rest_.size());
  nodes_.mean_rotations(element_rotations, volumes_, nodes_.all_nodes(), rotations.data());
}

void CorotationalModel::assemble(double mass_factor, double stiffness_factor,
                                 const CornerVectors& gradients, BlockMatrix& out) const {
  plan_.assemble_off_diagonal(gradients, stiffness_factor, plan_.all_bands(), out);
  plan_.assemble_diagonal(mass_factor, masses_, plan_.all_bands(), out);
}

void CorotationalModel::assemble(double mass_factor, double stiffness_factor,
                                 const std::vector<Mat3>& element_rotations, BlockMatrix& out) const {
  CornerVectors gradients = make_corner_vectors();
  elements_.gradients(element_rotations.data(), elements_.all_packs(), gradients.data());
  assemble(mass_factor, stiffness_factor, gradients, out);
}

void CorotationalModel::assemble_rest(double mass_factor, double stiffness_factor,
                                      BlockMatrix& out) const {
  CornerVectors gradients = make_corner_vectors();
  elements_.gradients(nullptr, elements_.all_packs(), gradients.data());
  assemble(mass_factor, stiffness_factor, gradients, out);
}

void CorotationalModel::add_corner_forces(const CornerVectors& corner_forces,
                                          Eigen::VectorXd& forces) const {
  nodes_.add_corners(corner_forces, nodes_.all_nodes(), forces.data());
}

void CorotationalModel::add_elastic_forces(const Eigen::VectorXd& x,
                                           const std::vector<Mat3>& element_rotations,
                                           CornerVectors& scratch, Eigen::VectorXd& forces) const {
  elements_.forces(x.data(), element_rotations.data(), elements_.all_packs(), scratch.data());
  add_corner_forces(scratch, forces);
}

void CorotationalModel::add_elastic_forces(const Eigen::VectorXd& x,
                                           const std::vector<Mat3>& element_rotations,
                                           Eigen::VectorXd& forces) const {
  CornerVectors scratch = make_corner_vectors();
  add_elastic_forces(x, element_rotations, scratch, forces);
}

double CorotationalModel::elastic_energy(const Eigen::VectorXd& x,
                                         const std::vector<Mat3>& element_rotations) const {
  return elements_.energy(x.data(), element_rotations.data());
}

Index CorotationalModel::worst_element() const {
  Index worst = 0;
  double worst_quality = INFINITY;
  for (Index t = 0; t < tet_count(); ++t) {
    double edges2 = 0;
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j)
        edges2 += (as_vec3(rest_[tets_[t][i]]) - as_vec3(rest_[tets_[t][j]])).squaredNorm();
    const double quality = volumes_[t] / std::pow(edges2 / 6, 1.5);
    if (quality < worst_quality) {
      worst_quality = quality;
      worst = t;
    }
  }
  return worst;
}

}  // namespace souple
