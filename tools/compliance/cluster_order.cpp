// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

#include "runtime/fem/linear_algebra.hpp"
#include "tools/compliance/hierarchical_encoder.hpp"

namespace souple {
namespace {

// Unit vector along which the positions of `rows` spread most.
Vec3 principal_axis(std::span<const Point> positions, std::span<const Index> rows) {
  Vec3 mean = Vec3::Zero();
  for (const Index row : rows) mean += as_vec3(positions[std::size_t(row)]);
  mean /= double(rows.size());
  Mat3 spread = Mat3::Zero();
  for (const Index row : rows) {
    const Vec3 arm = as_vec3(positions[std::size_t(row)]) - mean;
    spread += arm * arm.transpose();
  }
  const double size = spread.trace();
  if (!(size > 0)) return Vec3::UnitX();
  return Eigen::SelfAdjointEigenSolver<Mat3>(spread / size).eigenvectors().col(2);
}

}  // namespace

std::vector<Index> cluster_order(std::span<const Point> positions) {
  std::vector<Index> order(positions.size());
  std::vector<double> along(positions.size());
  std::iota(order.begin(), order.end(), Index{0});
  const auto count = Index(positions.size());
  // Down to single nodes, so that the order does not depend on the depth of the tree.
  for (int depth = 0; (std::int64_t{1} << depth) < count; ++depth)
    for (Index i = 0; i < (Index{1} << depth); ++i) {
      const ClusterRange range = cluster_range(count, depth, i);
      if (range.size() < 2) continue;
      const std::span rows(order.data() + range.begin, std::size_t(range.size()));
      const Vec3 axis = principal_axis(positions, rows);
      for (const Index row : rows)
        along[std::size_t(row)] = axis.dot(as_vec3(positions[std::size_t(row)]));
      std::ranges::sort(rows, [&](Index a, Index b) {
        const double xa = along[std::size_t(a)], xb = along[std::size_t(b)];
        return xa != xb ? xa < xb : a < b;
      });
    }
  return order;
}

int cluster_depth(Index node_count, Index leaf_nodes) {
  int depth = 0;
  while ((node_count >> depth) > std::max(leaf_nodes, Index{1})) ++depth;
  return depth;
}

}  // namespace souple
