// SPDX-License-Identifier: MIT
// A load of one body, checked and prepared. Internal to the world.
#pragma once
#include <span>
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/fem/linear_algebra.hpp"
#include "runtime/world/loads.hpp"

namespace souple {

class SoftBodyAsset;

class AppliedLoad {
 public:
  /// `x`: positions that a dead pressure takes its normals from. Issue load_invalid.
  static Result<AppliedLoad> create(const LoadDescription& description, const SoftBodyAsset& asset,
                                    const Eigen::VectorXd& x);

  bool changes() const { return course_.size() > 1; }  ///< with time
  bool is_pressure() const { return kind_ == LoadKind::pressure; }
  /// From now on this value, at all times. Issue load_invalid, unchanged. Allocates nothing.
  Status set(const LoadKeyframe& value, const std::string& where);
  /// forces += those of this load at `time_s`, N on 3n entries.
  void add_to(Eigen::VectorXd& forces, double time_s, const Eigen::VectorXd& x,
              std::span<const Mat3> node_rotations) const;

 private:
  LoadKeyframe at(double time_s) const;
  void weigh_nodes(const LoadDescription& description, const SoftBodyAsset& asset);
  void weigh_areas(std::span<const Index> triangles, const SoftBodyAsset& asset,
                   const Eigen::VectorXd& x);
  void add_present_pressure(Eigen::VectorXd& forces, double pressure_pa,
                            const Eigen::VectorXd& x) const;

  LoadKind kind_ = LoadKind::node_force;
  bool follows_ = false;
  std::vector<LoadKeyframe> course_;
  std::vector<Index> nodes_;
  std::vector<double> weights_;      ///< by node: share of a force, or m^2
  std::vector<Vec3> areas_;          ///< by node, dead pressure: outward, m^2
  std::vector<Triangle> triangles_;  ///< following pressure
};

}  // namespace souple
