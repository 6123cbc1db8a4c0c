// SPDX-License-Identifier: MIT
#include "runtime/collision/box_features.hpp"

#include <cmath>
#include <limits>

namespace souple {

Ridge PlacedBox::edge(int k) const {
  const int along = k / 4, u = (along + 1) % 3, v = (along + 2) % 3;
  const double su = (k & 1) != 0 ? 1 : -1, sv = (k & 2) != 0 ? 1 : -1;
  const Vec3 middle = at_.translation + su * half_[u] * axis(u) + sv * half_[v] * axis(v);
  Ridge ridge;
  ridge.from = middle - half_[along] * axis(along);
  ridge.to = middle + half_[along] * axis(along);
  ridge.inward = {-su * axis(u), -sv * axis(v)};
  ridge.outward = (su * axis(u) + sv * axis(v)).normalized();
  return ridge;
}

SeparatingAxis widest_gap(const PlacedBox& a, const PlacedBox& b) {
  SeparatingAxis widest{Vec3::UnitZ(), -std::numeric_limits<double>::infinity()};
  const Vec3 offset = a.centre() - b.centre();
  const auto try_axis = [&](const Vec3& axis) {
    const double length = axis.norm();
    if (!(length > 1e-6)) return;  // parallel sides: others serve
    double shadow = 0;
    for (int k = 0; k < 3; ++k)
      shadow += a.half(k) * std::abs(a.axis(k).dot(axis)) + b.half(k) * std::abs(b.axis(k).dot(axis));
    const double gap = (std::abs(offset.dot(axis)) - shadow) / length;
    if (gap > widest.gap) widest = {std::copysign(1 / length, offset.dot(axis)) * axis, gap};
  };
  for (int i = 0; i < 3; ++i) {
    try_axis(a.axis(i));
    try_axis(b.axis(i));
    for (int j = 0; j < 3; ++j) try_axis(a.axis(i).cross(b.axis(j)));
  }
  return widest;
}

}  // namespace souple
