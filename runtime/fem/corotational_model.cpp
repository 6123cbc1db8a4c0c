// SPDX-License-Identifier: MIT
#include "runtime/fem/corotational_model.hpp"

#include <cmath>

#include "runtime/fem/polar_rotation.hpp"

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

// Gradients of the barycentric shape functions; det(edges) > 0 is checked before.
Gradients shape_gradients(const TetMesh& mesh, const Tet& tet) {
  const Vec3 origin = as_vec3(mesh.nodes[tet[0]]);
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = as_vec3(mesh.nodes[tet[k + 1]]) - origin;
  const Mat3 inverse = edges.inverse();
  Gradients gradients;
  for (int k = 0; k < 3; ++k) gradients.col(k + 1) = inverse.row(k).transpose();
  gradients.col(0) = -(gradients.col(1) + gradients.col(2) + gradients.col(3));
  return gradients;
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
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (auto status = check_tet(mesh, t); !status) return status.issue();
    const auto& tet = mesh.tets[t];
    const auto& region = material.regions[material.tet_region.empty() ? 0 : material.tet_region[t]];
    const double volume =
        signed_volume6(mesh.nodes[tet[0]], mesh.nodes[tet[1]], mesh.nodes[tet[2]], mesh.nodes[tet[3]]) /
        6;
    const Gradients gradients = shape_gradients(mesh, tet);
    if (!gradients.allFinite()) return element_issue(t, "is flat to working precision");
    model.elements_.push_back({gradients, volume, lame_parameters(region.young_pa, region.poisson)});
    for (const Index node : tet) model.masses_[node] += 0.25 * volume * region.density_kg_m3;
    model.total_mass_ += volume * region.density_kg_m3;
  }
  for (std::size_t node = 0; node < model.masses_.size(); ++node)
    if (!(model.masses_[node] > 0))
      return make_issue(IssueCode::mesh_element_invalid,
                        "node " + std::to_string(node) + " belongs to no tetrahedron");
  model.pattern_ = build_block_pattern(model.node_count(), model.tets_);
  model.build_incidence();
  return model;
}

void CorotationalModel::build_incidence() {
  scatter_.resize(tets_.size());
  for (std::size_t t = 0; t < tets_.size(); ++t)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) scatter_[t][4 * i + j] = pattern_.find(tets_[t][i], tets_[t][j]);
  incidence_begin_.assign(rest_.size() + 1, 0);
  for (const auto& tet : tets_)
    for (const Index node : tet) ++incidence_begin_[node + 1];
  for (std::size_t node = 0; node < rest_.size(); ++node)
    incidence_begin_[node + 1] += incidence_begin_[node];
  incident_tets_.resize(4 * tets_.size());
  std::vector<Index> next(incidence_begin_.begin(), incidence_begin_.end() - 1);
  for (std::size_t t = 0; t < tets_.size(); ++t)
    for (const Index node : tets_[t]) incident_tets_[next[node]++] = static_cast<Index>(t);
}

std::size_t CorotationalModel::bytes() const {
  return rest_.size() * sizeof(Point) + tets_.size() * sizeof(Tet) +
         elements_.size() * sizeof(Element) + masses_.size() * sizeof(double) +
         scatter_.size() * sizeof(scatter_[0]) +
         (pattern_.row_begin.size() + pattern_.column.size() + pattern_.diagonal.size() +
          incidence_begin_.size() + incident_tets_.size()) *
             sizeof(Index);
}

void CorotationalModel::element_rotations(const Eigen::VectorXd& x,
                                          std::vector<Mat3>& rotations) const {
  rotations.resize(elements_.size());
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    Mat3 f = Mat3::Zero();  // deformation gradient: sum of x_i (grad N_i)^T
    for (int i = 0; i < 4; ++i)
      f.noalias() += node_entry(x, tets_[t][i]) * elements_[t].gradients.col(i).transpose();
    rotations[t] = polar_rotation(f);
  }
}

void CorotationalModel::node_rotations(const std::vector<Mat3>& element_rotations,
                                       std::vector<Mat3>& rotations) const {
  rotations.resize(rest_.size());
  for (std::size_t node = 0; node < rest_.size(); ++node) {
    Mat3 mean = Mat3::Zero();
    for (Index k = incidence_begin_[node]; k < incidence_begin_[node + 1]; ++k)
      mean += elements_[incident_tets_[k]].volume * element_rotations[incident_tets_[k]];
    rotations[node] = polar_rotation(mean);
  }
}

void CorotationalModel::start_assembly(double mass_factor, BlockMatrix& out) const {
  std::ranges::fill(out.values, 0.0);
  for (Index node = 0; node < node_count(); ++node)
    out.block(pattern_.diagonal[node]).diagonal().setConstant(mass_factor * masses_[node]);
}

// Block (i, j) of R K_e R^T is V (lambda g_i g_j^T + mu g_j g_i^T + mu (g_i . g_j) I) with g = R grad
// N.
void CorotationalModel::add_element(const Element& element, const Gradients& g, double factor,
                                    Index tet, BlockMatrix& out) const {
  const double lambda = factor * element.volume * element.lame.lambda;
  const double mu = factor * element.volume * element.lame.mu;
  for (int i = 0; i < 4; ++i)
    for (int j = i; j < 4; ++j) {
      Mat3 block = (lambda * g.col(i)) * g.col(j).transpose();
      block.noalias() += (mu * g.col(j)) * g.col(i).transpose();
      block.diagonal().array() += mu * g.col(i).dot(g.col(j));
      out.block(scatter_[tet][4 * i + j]) += block;
      if (i != j) out.block(scatter_[tet][4 * j + i]) += block.transpose();
    }
}

void CorotationalModel::assemble(double mass_factor, double stiffness_factor,
                                 const std::vector<Mat3>& element_rotations, BlockMatrix& out) const {
  start_assembly(mass_factor, out);
  for (Index t = 0; t < tet_count(); ++t) {
    const Gradients rotated = element_rotations[t] * elements_[t].gradients;
    add_element(elements_[t], rotated, stiffness_factor, t, out);
  }
}

void CorotationalModel::assemble_rest(double mass_factor, double stiffness_factor,
                                      BlockMatrix& out) const {
  start_assembly(mass_factor, out);
  for (Index t = 0; t < tet_count(); ++t)
    add_element(elements_[t], elements_[t].gradients, stiffness_factor, t, out);
}

// Forces R V (lambda tr(e) I + 2 mu e) grad N_i of the strain e of u = R^T x - x0: K_e u without K_e.
Eigen::Matrix<double, 3, 4> CorotationalModel::element_forces(Index tet, const Eigen::VectorXd& x,
                                                              const Mat3& r, double* energy) const {
  const Element& element = elements_[tet];
  Mat3 displacement_gradient = -Mat3::Identity();
  for (int i = 0; i < 4; ++i)
    displacement_gradient.noalias() +=
        (r.transpose() * node_entry(x, tets_[tet][i])) * element.gradients.col(i).transpose();
  const Mat3 strain = 0.5 * (displacement_gradient + displacement_gradient.transpose());
  Mat3 stress = 2 * element.lame.mu * strain;
  stress.diagonal().array() += element.lame.lambda * strain.trace();
  if (energy) *energy += 0.5 * element.volume * stress.cwiseProduct(strain).sum();
  return element.volume * (r * (stress * element.gradients));
}

void CorotationalModel::add_elastic_forces(const Eigen::VectorXd& x,
                                           const std::vector<Mat3>& element_rotations,
                                           Eigen::VectorXd& forces) const {
  for (Index t = 0; t < tet_count(); ++t) {
    const auto f = element_forces(t, x, element_rotations[t], nullptr);
    for (int i = 0; i < 4; ++i) node_entry(forces, tets_[t][i]) -= f.col(i);
  }
}

double CorotationalModel::elastic_energy(const Eigen::VectorXd& x,
                                         const std::vector<Mat3>& element_rotations) const {
  double energy = 0;
  for (Index t = 0; t < tet_count(); ++t) element_forces(t, x, element_rotations[t], &energy);
  return energy;
}

Index CorotationalModel::worst_element() const {
  Index worst = 0;
  double worst_quality = INFINITY;
  for (Index t = 0; t < tet_count(); ++t) {
    double edges2 = 0;
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j)
        edges2 += (as_vec3(rest_[tets_[t][i]]) - as_vec3(rest_[tets_[t][j]])).squaredNorm();
    const double quality = elements_[t].volume / std::pow(edges2 / 6, 1.5);
    if (quality < worst_quality) {
      worst_quality = quality;
      worst = t;
    }
  }
  return worst;
}

}  // namespace souple
