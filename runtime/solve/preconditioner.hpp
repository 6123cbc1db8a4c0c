// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <span>

#include "formats/core/result.hpp"
#include "runtime/fem/block_matrix.hpp"

namespace souple {

class SparseFactor;

/// The linear system of a step, A dx = b; fixed nodes have identity rows and columns.
struct StepSystem {
  const BlockMatrix* tangent = nullptr;    ///< A, symmetric positive definite
  std::span<const Mat3> node_rotations{};  ///< of every node, for what is made in the rest shape
};

/// z = M^-1 r for an M that resembles A: symmetric positive definite where conjugate gradients use it.
/// Everything is allocated when it is made; update and apply allocate nothing unless they say so.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  /// Takes over the A of this step. Called before apply whenever A has changed. False: A was not
  /// positive definite where it had to be inverted.
  virtual bool update(const StepSystem& system) = 0;
  virtual void apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) = 0;
  /// Cost of one apply in work units: products with the finest A.
  virtual double work_units() const = 0;
  virtual std::size_t bytes() const = 0;
  /// The factor of A on the nodes that move, if it is what apply solves with.
  virtual const SparseFactor* factor() const { return nullptr; }
};

}  // namespace souple
