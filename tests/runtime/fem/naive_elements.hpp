// SPDX-License-Identifier: MIT
// The slow way to what the element kernels compute: one tet after the other, K_e = V B^T D B with an
// explicit 6x12 B, rotations by polar_rotation.
#pragma once
#include <Eigen/Dense>
#include <vector>

#include "formats/core/asset.hpp"
#include "runtime/fem/block_matrix.hpp"
#include "runtime/fem/polar_rotation.hpp"

namespace souple::test {

class NaiveElements {
 public:
  NaiveElements(const TetMesh& mesh, const Material& material) : mesh_(mesh) {
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
      const std::size_t region = material.tet_region.empty() ? 0 : std::size_t(material.tet_region[t]);
      elements_.push_back(element_of(mesh.tets[t], material.regions[region]));
    }
  }

  Mat3 gradient(std::size_t t, const Eigen::VectorXd& x) const {
    const Tet& tet = mesh_.tets[t];
    Mat3 edges;
    for (std::size_t k = 0; k < 3; ++k)
      edges.col(Eigen::Index(k)) = node_entry(x, tet[k + 1]) - node_entry(x, tet[0]);
    return edges * elements_[t].inverse_edges;
  }

  std::vector<Mat3> rotations(const Eigen::VectorXd& x) const {
    std::vector<Mat3> result;
    for (std::size_t t = 0; t < elements_.size(); ++t) result.push_back(polar_rotation(gradient(t, x)));
    return result;
  }

  /// -sum R K_e (R^T x - x0), and the energy.
  Eigen::VectorXd forces(const Eigen::VectorXd& x, const std::vector<Mat3>& rotations,
                         double& energy) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(x.size());
    energy = 0;
    for (std::size_t t = 0; t < elements_.size(); ++t) {
      const Tet& tet = mesh_.tets[t];
      // From node 0, so that a body far away loses no digits.
      Eigen::Matrix<double, 12, 1> u;
      for (std::size_t i = 0; i < 4; ++i)
        u.segment<3>(Eigen::Index(3 * i)) =
            rotations[t].transpose() * (node_entry(x, tet[i]) - node_entry(x, tet[0])) -
            (as_vec3(mesh_.nodes[std::size_t(tet[i])]) - as_vec3(mesh_.nodes[std::size_t(tet[0])]));
      const Eigen::Matrix<double, 12, 1> f = elements_[t].stiffness * u;
      energy += 0.5 * u.dot(f);
      for (std::size_t i = 0; i < 4; ++i)
        node_entry(sum, tet[i]) -= rotations[t] * f.segment<3>(Eigen::Index(3 * i));
    }
    return sum;
  }

  BlockMatrix stiffness(const std::vector<Mat3>& rotations, const BlockPattern& pattern) const {
    BlockMatrix sum(pattern);
    for (std::size_t t = 0; t < elements_.size(); ++t)
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
          sum.block(pattern.find(mesh_.tets[t][i], mesh_.tets[t][j])) +=
              rotations[t] *
              elements_[t].stiffness.block<3, 3>(Eigen::Index(3 * i), Eigen::Index(3 * j)) *
              rotations[t].transpose();
    return sum;
  }

 private:
  struct Element {
    Eigen::Matrix<double, 12, 12> stiffness;
    Mat3 inverse_edges;
  };

  Element element_of(const Tet& tet, const MaterialRegion& region) const {
    Mat3 edges;
    for (std::size_t k = 0; k < 3; ++k)
      edges.col(Eigen::Index(k)) =
          as_vec3(mesh_.nodes[std::size_t(tet[k + 1])]) - as_vec3(mesh_.nodes[std::size_t(tet[0])]);
    const Mat3 inverse = edges.inverse();
    Eigen::Matrix<double, 6, 12> b = Eigen::Matrix<double, 6, 12>::Zero();
    for (Eigen::Index i = 0; i < 4; ++i) {
      const Vec3 g =
          i == 0 ? Vec3(-inverse.colwise().sum().transpose()) : Vec3(inverse.row(i - 1).transpose());
      b.block<3, 3>(0, 3 * i).diagonal() = g;
      b.row(3).segment<3>(3 * i) << g.y(), g.x(), 0;
      b.row(4).segment<3>(3 * i) << 0, g.z(), g.y();
      b.row(5).segment<3>(3 * i) << g.z(), 0, g.x();
    }
    const double e = region.young_pa, nu = region.poisson;
    Eigen::Matrix<double, 6, 6> d = Eigen::Matrix<double, 6, 6>::Zero();
    d.topLeftCorner<3, 3>().setConstant(e * nu / ((1 + nu) * (1 - 2 * nu)));
    d.diagonal().head<3>().array() += e / (1 + nu);
    d.diagonal().tail<3>().setConstant(e / (2 * (1 + nu)));
    return {edges.determinant() / 6 * b.transpose() * d * b, inverse};
  }

  const TetMesh& mesh_;
  std::vector<Element> elements_;
};

}  // namespace souple::test
