// SPDX-License-Identifier: MIT
// Element-wise corotational linear tetrahedra (Etzmuss et al. 2003; METHOD 1): the constant part.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "runtime/fem/block_matrix.hpp"

namespace souple {

/// Lamé parameters, Pa.
struct Lame {
  double lambda = 0;
  double mu = 0;
};
Lame lame_parameters(double young_pa, double poisson);

/// Everything about the rest shape that a step needs. Const and shared by all instances of a body.
class CorotationalModel {
 public:
  /// Issues: mesh_element_invalid (names the tet), material_out_of_range.
  static Result<CorotationalModel> create(const TetMesh& mesh, const Material& material);

  Index node_count() const { return static_cast<Index>(rest_.size()); }
  Index tet_count() const { return static_cast<Index>(elements_.size()); }
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
  void element_rotations(const Eigen::VectorXd& x, std::vector<Mat3>& rotations) const;
  /// Rotation of every node: mean of the incident elements' weighted by volume, projected onto SO(3)
  /// (METHOD 4.1).
  void node_rotations(const std::vector<Mat3>& element_rotations, std::vector<Mat3>& rotations) const;

  /// out = mass_factor M + stiffness_factor sum_e R_e K_e R_e^T. Values in a fixed order.
  void assemble(double mass_factor, double stiffness_factor, const std::vector<Mat3>& element_rotations,
                BlockMatrix& out) const;
  /// The same in the rest shape: A0.
  void assemble_rest(double mass_factor, double stiffness_factor, BlockMatrix& out) const;

  /// f -= sum_e R_e K_e (R_e^T x - x0): the elastic force on the nodes, N.
  void add_elastic_forces(const Eigen::VectorXd& x, const std::vector<Mat3>& element_rotations,
                          Eigen::VectorXd& forces) const;
  /// Sum of 1/2 u_e^T K_e u_e with u_e = R_e^T x - x0, J.
  double elastic_energy(const Eigen::VectorXd& x, const std::vector<Mat3>& element_rotations) const;

  /// The tet whose rest shape is worst (volume over cubed root-mean-square edge): for messages.
  Index worst_element() const;

 private:
  struct Element {
    Gradients gradients;  ///< of the shape functions in the rest shape
    double volume;        ///< m^3
    Lame lame;
  };

  void add_element(const Element& element, const Gradients& rotated, double factor, Index tet,
                   BlockMatrix& out) const;
  void start_assembly(double mass_factor, BlockMatrix& out) const;
  Eigen::Matrix<double, 3, 4> element_forces(Index tet, const Eigen::VectorXd& x, const Mat3& r,
                                             double* energy) const;
  void build_incidence();

  std::vector<Point> rest_;
  std::vector<Tet> tets_;
  std::vector<Element> elements_;
  std::vector<double> masses_;
  double total_mass_ = 0;
  double rayleigh_mass_ = 0, rayleigh_stiffness_ = 0;
  BlockPattern pattern_;
  std::vector<std::array<Index, 16>> scatter_;  ///< block of (i, j) of every tet: no searching per step
  std::vector<Index> incidence_begin_, incident_tets_;
};

}  // namespace souple
