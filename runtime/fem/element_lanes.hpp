// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <vector>

#include "runtime/fem/lanes.hpp"
#include "runtime/fem/rotation_method.hpp"

namespace souple {

/// Lamé parameters, Pa.
struct Lame {
  double lambda = 0;
  double mu = 0;
};

/// A vector of one corner of a tet: x, y, z, 0.
struct alignas(32) CornerVector {
  double entry[4];
};
/// Corner i of tet t at 4 t + i. Scratch of a step.
using CornerVectors = std::vector<CornerVector>;

struct PackShape {
  alignas(32) double inverse_edges[9][lane_count];  ///< row-major, 1/m
  alignas(16) Index node[4][lane_count];
};
struct PackStiffness {
  alignas(32) double lambda[lane_count];  ///< V lambda, J
  alignas(32) double mu[lane_count];      ///< V mu, J
};

/// Where ElementLanes::evaluate writes; room for all tets of the body.
struct ElementTerms {
  Mat3* rotations = nullptr;          ///< R by tet
  CornerVector* gradients = nullptr;  ///< sqrt(V mu) R grad N_i; null: rotations only
  /// -V sigma R grad N_i, N, sigma of the strain sym(F R^T) - I; only with gradients.
  CornerVector* forces = nullptr;
};

/// The elements of a body in packs of four, one in each lane, and the kernels over them. A kernel
/// treats a range of packs, and writes to nothing else than the tets in it; what it computes for a tet
/// does not depend on the range.
class ElementLanes {
 public:
  void reserve(std::size_t tet_count);
  /// `inverse_edges`: of the matrix whose columns are x1-x0, x2-x0, x3-x0 at rest, 1/m.
  void add(const Tet& tet, const Mat3& inverse_edges, double volume, const Lame& lame);

  Index tet_count() const { return tet_count_; }
  IndexRange all_packs() const { return {0, static_cast<Index>(shapes_.size())}; }
  std::size_t bytes() const;

  /// All that a step needs of the shape x (3n), in one pass.
  void evaluate(const double* x, RotationMethod method, IndexRange packs,
                const ElementTerms& out) const;
  /// Gradients for given rotations of the tets; none: R = I.
  void gradients(const Mat3* rotations, IndexRange packs, CornerVector* out) const;
  /// Forces in the shape x for given rotations.
  void forces(const double* x, const Mat3* rotations, IndexRange packs, CornerVector* out) const;
  /// Sum of V sigma : eps / 2, J.
  double energy(const double* x, const Mat3* rotations) const;

 private:
  Index count_in(Index pack) const { return std::min(lane_count, tet_count_ - lane_count * pack); }
  template <RotationMethod method>
  void evaluate_by(const double* x, IndexRange packs, const ElementTerms& out) const;

  std::vector<PackShape> shapes_;  ///< lanes beyond the last tet repeat it
  std::vector<PackStiffness> stiffnesses_;
  Index tet_count_ = 0;
};

}  // namespace souple
