// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// Mean-ratio quality of a tet, 12 (3 V)^(2/3) / sum of squared edge lengths: 1 for the regular tet, 0
/// for a flat one, negative for an inverted one.
double mean_ratio(const Point& a, const Point& b, const Point& c, const Point& d);
double mean_ratio(const Tet& tet, const std::vector<Point>& nodes);

/// Distortion s = mean ratio^-3 = (sum of squared edges)^3 / (432 (6 V)^2) as a function of corner x,
/// with the opposite face (b, c, d) wound inward. For V > 0 it is smooth and convex, and grows without
/// bound towards the flat tet. Scale-free.
struct Distortion {
  double value = 0;         ///< infinity where the tet is not positive
  Point log_gradient{};     ///< of log s
  double log_hessian[6]{};  ///< of log s: xx, yy, zz, xy, xz, yz
};
double distortion_value(const Point& x, const Point& b, const Point& c, const Point& d);
Distortion distortion(const Point& x, const Point& b, const Point& c, const Point& d);

/// The corner's opposite face, wound inward: (tet[corner], face…) is positive if the tet is.
inline constexpr int inward_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/// The tets of every node with the node's place in them, as one list with offsets.
class NodeTets {
 public:
  struct Corner {
    Index tet;
    Index corner;
  };
  explicit NodeTets(const TetMesh& mesh);
  std::span<const Corner> of(std::size_t node) const {
    return {corners_.data() + first_[node], first_[node + 1] - first_[node]};
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<Corner> corners_;
};

}  // namespace souple
