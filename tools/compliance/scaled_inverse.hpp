// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "tools/compliance/surface_inverse.hpp"
#include "tools/compliance/worker_pool.hpp"

namespace souple {

/// C~ = S^-1 C S^-T in cluster order, S = blockdiag(L_a) with lower triangles L_a, by solves.
class ScaledInverse {
 public:
  /// `order`: surface node at every position. `scale`: L_a of every surface node, of unit() C.
  ScaledInverse(const SurfaceInverse& inverse, std::span<const Index> order,
                std::span<const Mat3> scale);

  /// Takes the `count` or so smoothest vectors V out of what is solved for in single precision: with
  /// P = 1 - V V^T and Z = C~ V from solves in double, C~ = P C~ P + Z V^T + V Z^T P exactly. Rounding
  /// errors of single solves grow with the square of what is left of the norm of C~.
  void deflate(Eigen::Index count, WorkerPool& pool);

  /// From now on all solves are in double, though vectors stay in single precision.
  void refine() { refined_ = true; }

  /// x := C~ x in single precision.
  void apply(FloatRef x, SurfaceInverse::Work& work) const;
  /// The same by solves in double.
  void apply_refined(Eigen::Ref<Eigen::MatrixXd> x, SurfaceInverse::Work& work) const;
  Eigen::Index size() const { return 3 * Eigen::Index(places_.size()); }

 private:
  void apply_plainly(FloatRef x, SurfaceInverse::Work& work) const;
  template <class Matrix>
  void to_forces(Matrix& x) const;
  template <class Matrix>
  void from_displacements(Matrix& x) const;

  const SurfaceInverse& inverse_;
  std::vector<std::int64_t> places_;
  std::vector<Mat3> unscale_;     ///< L_a^-1 by position
  Eigen::MatrixXf smooth_;        ///< V
  Eigen::MatrixXf smooth_image_;  ///< Z
  bool refined_ = false;
};

}  // namespace souple
