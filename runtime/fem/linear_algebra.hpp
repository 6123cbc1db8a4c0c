// SPDX-License-Identifier: MIT
// Names for the fixed-size Eigen types, and views of plain points as Eigen vectors.
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <span>

#include "formats/core/mesh.hpp"

namespace souple {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Gradients = Eigen::Matrix<double, 3, 4>;  ///< column i: gradient of shape function i, 1/m

inline Eigen::Map<const Vec3> as_vec3(const Point& p) { return Eigen::Map<const Vec3>(p.data()); }
inline Eigen::Map<Vec3> as_vec3(Point& p) { return Eigen::Map<Vec3>(p.data()); }
inline Point as_point(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Half-open range of rows, nodes or packs: what one job of an application does.
struct IndexRange {
  Index begin = 0, end = 0;
};

/// Entries of node `node` in a node-major xyz vector of length 3n.
inline auto node_entry(Eigen::VectorXd& v, Index node) { return v.segment<3>(3 * Eigen::Index{node}); }
inline auto node_entry(const Eigen::VectorXd& v, Index node) {
  return v.segment<3>(3 * Eigen::Index{node});
}

}  // namespace souple
