// SPDX-License-Identifier: MIT
#include "runtime/contact/faceted_contact.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace souple {
namespace {

using Vec2 = Eigen::Vector2d;

// The constants of a contact's own block; 0 inverses if nothing can move it.
struct FacetedLaw {
  double inverse_normal = 0, inverse_tangential = 0, friction = 0;
  Vec2 coupling = Vec2::Zero();

  FacetedLaw(const Mat3& block, double mu) : friction(mu), coupling(block.bottomLeftCorner<2, 1>()) {
    const double tangential = 0.5 * (block(1, 1) + block(2, 2));
    if (!block.allFinite() || !(block(0, 0) > 0)) return;
    inverse_normal = 1 / block(0, 0);
    inverse_tangential = tangential > 0 ? 1 / tangential : 0;
  }

  Vec3 next_force(const Vec3& gap, const Vec3& force, int facets) const {
    const double change = -gap[0] * inverse_normal, normal = force[0] + change;
    if (!(normal > 0)) return Vec3::Zero();
    const Vec2 slip = gap.tail<2>() + coupling * change;
    Vec3 next(normal, 0, 0);
    next.tail<2>() =
        project_onto_polygon(force.tail<2>() - inverse_tangential * slip, friction * normal, facets);
    return next;
  }
  // Zero if and only if the law holds; N.
  Vec3 map(const Vec3& gap, const Vec3& force, int facets) const {
    Vec3 target(std::max(force[0] - inverse_normal * gap[0], 0.0), 0, 0);
    target.tail<2>() = project_onto_polygon(force.tail<2>() - inverse_tangential * gap.tail<2>(),
                                            friction * target[0], facets);
    return force - target;
  }
};

}  // namespace

Vec2 project_onto_polygon(const Vec2& point, double radius, int facets) {
  if (!(radius > 0)) return Vec2::Zero();
  const double sector = 2 * std::numbers::pi / facets;
  const double middle = (std::floor(std::atan2(point[1], point[0]) / sector) + 0.5) * sector;
  const Vec2 normal(std::cos(middle), std::sin(middle)), along(-normal[1], normal[0]);
  const double distance = radius * std::cos(0.5 * sector), half = radius * std::sin(0.5 * sector);
  if (normal.dot(point) <= distance) return point;
  return distance * normal + std::clamp(along.dot(point), -half, half) * along;
}

ContactSolveReport solve_faceted_contact(BlockSparseOperator& op, std::span<const double> friction,
                                         int facets, const ContactSolverSettings& settings,
                                         std::span<double> force) {
  std::vector<FacetedLaw> laws;
  for (std::size_t i = 0; i < op.size(); ++i) laws.emplace_back(op.diagonal_block(i), friction[i]);
  ContactSolveReport report;
  op.start(force);
  while (report.sweeps < settings.max_sweeps && !report.converged) {
    double change2 = 0, force2 = 0, map2 = 0;
    for (std::size_t i = 0; i < op.size(); ++i) {
      Eigen::Map<Vec3> f(&force[3 * i]);
      const Vec3 gap = op.gap(i), next = laws[i].next_force(gap, f, facets);
      map2 += laws[i].map(gap, f, facets).squaredNorm();
      if (next != f) op.add_influence(i, next - f);
      change2 = std::max(change2, (next - f).squaredNorm());
      force2 += next.squaredNorm();
      f = next;
    }
    ++report.sweeps;
    report.residual = force2 > 0 ? std::sqrt(map2 / force2) : std::sqrt(map2);
    report.converged = report.residual <= settings.tolerance &&
                       change2 <= settings.tolerance * settings.tolerance * force2;
  }
  return report;
}

}  // namespace souple
