// SPDX-License-Identifier: MIT
// The slow, independent way to a compliance: assemble the matrix element by element from B^T D B and
// invert it densely.
#pragma once
#include <Eigen/Core>
#include <memory>

#include "runtime/world/soft_body_asset.hpp"

namespace souple::test {

/// Stiffness by V B^T D B with explicit 6x12 B, rotated by `rotation`: not the runtime's formula.
Eigen::MatrixXd dense_stiffness(const TetMesh& mesh, double young_pa, double poisson,
                                const Eigen::Matrix3d& rotation = Eigen::Matrix3d::Identity());
/// Lumped, by node.
Eigen::VectorXd lumped_masses(const TetMesh& mesh, double density);

/// (mass_factor M + stiffness_factor K)^-1 with zero rows and columns at the fixed nodes.
Eigen::MatrixXd dense_compliance(const TetMesh& mesh, const Material& material, double mass_factor,
                                 double stiffness_factor, const std::vector<Index>& fixed);

/// A body with one dynamic compliance for the time step, in double, from dense_compliance.
std::shared_ptr<const SoftBodyAsset> make_body(TetMesh mesh, const Material& material,
                                               double time_step_s,
                                               std::vector<FixedSet> fixed_sets = {},
                                               const std::string& fixed_set = {});

/// The same body as an asset that can be written to a file.
Asset make_asset(TetMesh mesh, const Material& material, double time_step_s,
                 std::vector<FixedSet> fixed_sets = {}, const std::string& fixed_set = {});

/// The asset content of the same body.
SoftBodyContent make_content(TetMesh mesh, const Material& material, double time_step_s,
                             std::vector<FixedSet> fixed_sets = {}, const std::string& fixed_set = {});

}  // namespace souple::test
