// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "formats/core/mesh.hpp"
#include "tools/geometry/triangle_bvh.hpp"

namespace souple {

/// Inside and distance for a closed, outward surface, which may intersect itself: inside is where the
/// generalised winding number (Jacobson et al. 2013) exceeds 1/2. Queries may run from several threads.
class SignedDistance {
 public:
  explicit SignedDistance(const TriangleMesh& surface);
  ~SignedDistance();
  SignedDistance(const SignedDistance&) = delete;
  SignedDistance& operator=(const SignedDistance&) = delete;

  bool contains(const Point& p) const;
  double distance(const Point& p) const;  ///< m, negative inside
  const TriangleBvh& triangles() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
