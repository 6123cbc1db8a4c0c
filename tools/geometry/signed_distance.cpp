// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/signed_distance.hpp"

#include <cmath>

#include "tools/geometry/winding_number.hpp"

namespace souple {

struct SignedDistance::Impl {
  TriangleBvh triangles;
  WindingNumber winding;
};

SignedDistance::SignedDistance(const TriangleMesh& surface)
    : impl_(new Impl{TriangleBvh(surface), WindingNumber(surface)}) {}
SignedDistance::~SignedDistance() = default;

bool SignedDistance::contains(const Point& p) const { return impl_->winding.at(p) > 0.5; }

double SignedDistance::distance(const Point& p) const {
  const double far = std::sqrt(impl_->triangles.closest(p).squared_distance);
  return contains(p) ? -far : far;
}

const TriangleBvh& SignedDistance::triangles() const { return impl_->triangles; }

}  // namespace souple
