// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <span>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// A symmetric 3n x 3n matrix over nodes that can be read by sub-blocks: the rest compliance, dense in
/// memory. Const members may be called from several threads at once.
class SymmetricSource {
 public:
  virtual ~SymmetricSource() = default;
  virtual Index node_count() const = 0;
  /// out, 3 |rows| x 3 |columns|: the block of these nodes (rows of the compliance), m/N.
  virtual void read(std::span<const Index> rows, std::span<const Index> columns,
                    Eigen::Ref<Eigen::MatrixXf> out) const = 0;
  virtual void read(std::span<const Index> rows, std::span<const Index> columns,
                    Eigen::Ref<Eigen::MatrixXd> out) const = 0;
};

/// A symmetric 3n x 3n matrix that can only be applied: by solves where it is too large to be formed.
class SymmetricOperator {
 public:
  virtual ~SymmetricOperator() = default;
  virtual Index node_count() const = 0;
  /// y = C x; x and y are 3n x k, rows in the order of the compliance's rows.
  virtual void apply(const Eigen::Ref<const Eigen::MatrixXd>& x,
                     Eigen::Ref<Eigen::MatrixXd> y) const = 0;
  /// Some m >= 0 with C - m S S^T positive semi-definite, S = blockdiag of `scales` by rows; 0 where
  /// none is known.
  virtual double least_share(std::span<const Eigen::Matrix3d> scales) const;
};

inline double SymmetricOperator::least_share(std::span<const Eigen::Matrix3d>) const { return 0; }

}  // namespace souple
