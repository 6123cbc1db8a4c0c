// SPDX-License-Identifier: MIT
// The penalty method (METHOD 4.2.2), a baseline to be measured against: springs and friction against
// what has already penetrated, as forces of the free motion.
#include <algorithm>
#include <limits>

#include "runtime/world/world_state.hpp"

namespace souple {

// Of the lighter side that forces move, kg.
double World::State::mass_at(const Contact& c) const {
  double least = std::numeric_limits<double>::infinity();
  for (const ContactSide* side : {&c.a, &c.b}) {
    if (side->body == ContactSide::no_body || !is_movable(side->body)) continue;
    double mass = 0;
    if (!is_soft(side->body)) mass = rigid(side->body).free->mass;
    for (std::size_t k = 0; k < std::size_t(side->count); ++k)
      mass += side->weight[k] * soft(side->body).asset->model().masses()[std::size_t(side->node[k])];
    if (mass > 0) least = std::min(least, mass);
  }
  return least;
}

void World::State::apply_penalty() {
  const double h = settings.time_step_s;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    Eigen::Map<Vec3> f(applied.data() + 3 * i);
    const double mass = mass_at(c);
    const double stiffness =
        settings.penalty_stiffness_n_m > 0 ? settings.penalty_stiffness_n_m : mass / (h * h);
    const Vec3 slip = h * (c.frame.transpose() * (velocity_of(c.a) - velocity_of(c.b))) -
                      c.frame.transpose() * c.driven_motion;
    if (c.law.kind == ConstraintLaw::Kind::bilateral) {
      f = -stiffness * (Vec3(c.gap, c.offset[0], c.offset[1]) + slip);
    } else {
      // Where it would be at the end of the step without it.
      f = Vec3(std::max(0.0, -stiffness * (c.gap + slip[0])), 0, 0);
      f.tail<2>() = -stiffness * slip.tail<2>();
      const double limit = c.law.friction * f[0], size = f.tail<2>().norm();
      if (size > limit) f.tail<2>() *= limit / size;
    }
  }
  force = applied;
}

// What the gaps have become: there is nothing to be corrected.
void World::State::end_penalty() {
  gap.assign(3 * contacts.size(), 0.0);
  shift.assign(contacts.size(), 0.0);
  change.assign(3 * contacts.size(), 0.0);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    Eigen::Map<Vec3>(gap.data() + 3 * i) =
        Vec3(c.gap, c.offset[0], c.offset[1]) +
        c.frame.transpose() * (motion_of(c.a) - motion_of(c.b) - c.driven_motion);
  }
  free_gap = gap;
}

}  // namespace souple
