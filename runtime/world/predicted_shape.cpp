// SPDX-License-Identifier: MIT
#include "runtime/world/predicted_shape.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/world/rigid_velocity.hpp"

namespace souple {
namespace {

constexpr double largest_strain = 0.25;

// Root mean square over the edges at the first node of every tet of the rate at which they change, 1/s.
double strain_rate(const CorotationalModel& model, const Eigen::VectorXd& v) {
  const auto rest = model.rest_positions();
  double sum = 0;
  for (const Tet& tet : model.tets()) {
    const Vec3 corner = as_vec3(rest[std::size_t(tet[0])]), velocity = node_entry(v, tet[0]);
    for (std::size_t k = 1; k < 4; ++k)
      sum += (node_entry(v, tet[k]) - velocity).squaredNorm() /
             (as_vec3(rest[std::size_t(tet[k])]) - corner).squaredNorm();
  }
  return std::sqrt(sum / (3 * double(model.tet_count())));
}

}  // namespace

void predict_shape(const CorotationalModel& model, const Eigen::VectorXd& x, const Eigen::VectorXd& v,
                   double h, bool is_free, bool deforms, Eigen::VectorXd& shape) {
  const RigidVelocity rigid = is_free ? rigid_velocity(model, x, v) : RigidVelocity{};
  for (Index node = 0; node < model.node_count(); ++node)
    node_entry(shape, node) = node_entry(v, node) - rigid.at(node_entry(x, node));
  const double strain = h * strain_rate(model, shape);
  const double most = deforms ? 1 : std::min(1.0, 4 * h * h * rigid.angular.squaredNorm());
  const double share = strain > largest_strain ? most * largest_strain / strain : most;
  for (Index node = 0; node < model.node_count(); ++node) {
    const Vec3 position = node_entry(x, node);
    node_entry(shape, node) = position + h * (rigid.at(position) + share * node_entry(shape, node));
  }
}

}  // namespace souple
