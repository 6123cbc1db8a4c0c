// SPDX-License-Identifier: MIT
// Element-wise corotational linear tetrahedra (Etzmuss et al. 2003; METHOD 1): the constant part.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "runtime/fem/assembly_plan.hpp"
#include "runtime/fem/element_lanes.hpp"
#include "runtime/fem/node_gather.hpp"

namespace souple {

Lame lame_parameters(double young_pa, double poisson);

/// Everything about the rest shape that a step needs. Const and shared by all instances of a body.
class CorotationalModel {
 public:
  /// Issues: mesh_element_invalid (names the tet), material_out_of_range.
  static Result<CorotationalModel> create(const TetMesh& mesh, const Material& material);

  Index node_count() const { return static_cast<Index>(rest_.size()); }
  Index tet_count() const { return elements_.tet_count(); }
  std::span<const Point> rest_positions() const { return rest_; }
  std::span<const Tet> tets() const { return tets_; }
  const BlockPattern& pattern() const { return pattern_; }
  /// Lumped mass of every node, kg: a quarter of each incident tet's.
  std::span<const double> masses() const { return masses_; }
  double total_mass() const { return total_mass_; }
  double rayleigh_mass_per_s() const { return rayleigh_mass_; }
  double rayleigh_stiffness_s() const { return rayleigh_stiffness_; }
  std::size_t bytes() const;

  /// Rotation of every element in the deformed shape `x` (node-major, 3n).
  void element_rotations(const Eigen::VectorXd& x, std::vector<Mat3>& rotations,
                         RotationMethod method = RotationMethod::polar) const;
  /// Rotation of every node: mean of the incident elements' weighted by volume, projected onto SO(3)
  /// (METHOD 4.1).
  void node_rotations(const std::vector<Mat3>& element_rotations, std::vector<Mat3>& rotations) const;

  /// Room for the vectors of all corners, for the functions that take some.
  CornerVectors make_corner_vectors() const { return CornerVectors(4 * tets_.size()); }
  /// Rotations, and what assemble and add_corner_forces take, in one pass over the elements: the way of
  /// a step that needs them all.
  void evaluate_elements(const Eigen::VectorXd& x, RotationMethod method, std::vector<Mat3>& rotations,
                         CornerVectors& gradients, CornerVectors& corner_forces) const;

  /// out = mass_factor M + stiffness_factor sum_e R_e K_e R_e^T. Exactly symmetric, and rigid
  /// translations take no force but that of M; sums in a fixed order.
  void assemble(double mass_factor, double stiffness_factor, const CornerVectors& gradients,
                BlockMatrix& out) const;
  void assemble(double mass_factor, double stiffness_factor, const std::vector<Mat3>& element_rotations,
                BlockMatrix& out) const;
  /// The same in the rest shape: A0.
  void assemble_rest(double mass_factor, double stiffness_factor, BlockMatrix& out) const;
  /// Identity rows and columns for the nodes where `is_held` is not 0.
  void hold_nodes(std::span<const char> is_held, BlockMatrix& out) const { plan_.hold(is_held, out); }

  /// f -= sum_e R_e K_e (R_e^T x - x0): the elastic force on the nodes, N, from that on the corners.
  void add_corner_forces(const CornerVectors& corner_forces, Eigen::VectorXd& forces) const;
  /// The same from the shape; `scratch` is overwritten.
  void add_elastic_forces(const Eigen::VectorXd& x, const std::vector<Mat3>& element_rotations,
                          CornerVectors& scratch, Eigen::VectorXd& forces) const;
  void add_elastic_forces(const Eigen::VectorXd& x, const std::vector<Mat3>& element_rotations,
                          Eigen::VectorXd& forces) const;
  /// Sum of 1/2 u_e^T K_e u_e with u_e = R_e^T x - x0, J.
  double elastic_energy(const Eigen::VectorXd& x, const std::vector<Mat3>& element_rotations) const;

  /// The kernels behind the functions above, for those who split one body into jobs.
  const ElementLanes& elements() const { return elements_; }
  const AssemblyPlan& plan() const { return plan_; }
  const NodeGather& nodes() const { return nodes_; }
  /// m^3.
  std::span<const double> volumes() const { return volumes_; }

  /// The tet whose rest shape is worst (volume over cubed root-mean-square edge): for messages.
  Index worst_element() const;

 private:
  std::vector<Point> rest_;
  std::vector<Tet> tets_;
  std::vector<double> masses_, volumes_;
  double total_mass_ = 0;
  double rayleigh_mass_ = 0, rayleigh_stiffness_ = 0;
  BlockPattern pattern_;
  ElementLanes elements_;
  AssemblyPlan plan_;
  NodeGather nodes_;
};

}  // namespace souple
