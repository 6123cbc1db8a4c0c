// SPDX-License-Identifier: MIT
// The instances that a world steps. Internal to the world.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/collision/rigid_distance.hpp"
#include "runtime/collision/surface_tree.hpp"
#include "runtime/fem/conjugate_gradient.hpp"
#include "runtime/fem/sparse_factor.hpp"
#include "runtime/world/settings.hpp"
#include "runtime/world/soft_body_asset.hpp"

namespace souple {

/// State and work space of one soft body; everything is allocated when it is made.
struct SoftBody {
  SoftBody(std::shared_ptr<const SoftBodyAsset> shared, std::string name);

  /// Rotations of elements and nodes, tangent A and right side of the free motion for the present
  /// state: A = M/h^2 + B/h + K, b = M g - F_int + M v / h (METHOD 2). Contact forces are added to
  /// `load` afterwards.
  void prepare_free_motion(double time_step_s, const Vec3& gravity);
  /// Solves A dx = load into `motion`, from the motion of the last step.
  ConjugateGradientReport solve_free_motion(double time_step_s, const FreeMotionSettings& settings);
  /// The same from the motion there is, after forces were added to `load`.
  ConjugateGradientReport solve_from_motion(double time_step_s, const FreeMotionSettings& settings);
  double kinetic_energy() const;
  double elastic_energy();  ///< of the present positions
  double potential_energy(const Vec3& gravity) const;
  double largest_speed() const;

  std::shared_ptr<const SoftBodyAsset> asset;
  std::string name;
  const BodyCompliance* compliance = nullptr;  ///< warped contact
  double compliance_scale = 1;                 ///< stored C0 times this is A0^-1
  std::optional<SparseFactor> factor;          ///< exact contact: of the present A
  std::vector<char> is_fixed;                  ///< by node
  std::vector<Index> free_nodes;

  Eigen::VectorXd x, v;          ///< 3n, m and m/s
  Eigen::VectorXd motion, load;  ///< 3n: dx of this step, right side b
  Eigen::VectorXd rest_frame;
  Eigen::VectorXd work;               ///< exact contact
  std::vector<float> extension_work;  ///< warped contact
  std::vector<Mat3> element_rotations, node_rotations;
  BlockMatrix tangent;
  ConjugateGradient solver;
  DeformedSurface surface;

 private:
  void hold_fixed_nodes();

  double mass_norm_ = 0;  ///< root of the sum of squared nodal masses, kg
};

struct RigidBody {
  std::string name;
  RigidShape shape;
  std::vector<Keyframe> path;

  Pose pose_at(double time_s) const;
};

}  // namespace souple
