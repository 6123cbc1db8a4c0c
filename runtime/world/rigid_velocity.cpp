// SPDX-License-Identifier: MIT
#include "runtime/world/rigid_velocity.hpp"

namespace souple {

RigidVelocity rigid_velocity(const CorotationalModel& model, const Eigen::VectorXd& x,
                             const Eigen::VectorXd& v) {
  RigidVelocity rigid;
  for (Index node = 0; node < model.node_count(); ++node) {
    const double share = model.masses()[std::size_t(node)] / model.total_mass();
    rigid.centre += share * node_entry(x, node);
    rigid.linear += share * node_entry(v, node);
  }
  Mat3 inertia = Mat3::Zero();
  Vec3 momentum = Vec3::Zero();
  for (Index node = 0; node < model.node_count(); ++node) {
    const double mass = model.masses()[std::size_t(node)];
    const Vec3 arm = node_entry(x, node) - rigid.centre;
    inertia += mass * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
    momentum += mass * arm.cross(Vec3(node_entry(v, node) - rigid.linear));
  }
  rigid.angular = inertia.ldlt().solve(momentum);
  if (!rigid.angular.allFinite()) rigid.angular.setZero();
  return rigid;
}

}  // namespace souple
