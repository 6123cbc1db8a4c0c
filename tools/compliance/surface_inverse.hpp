// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "formats/core/result.hpp"
#include "tools/compliance/single_factor.hpp"
#include "tools/compliance/symmetric_source.hpp"

namespace souple {

/// The part of a block matrix on some nodes, rows and columns by elimination order.
struct OrderedMatrix {
  std::vector<std::int64_t> row_begin;  ///< [nodes + 1] blocks
  std::vector<std::int32_t> column;     ///< first scalar of the block's column
  std::vector<std::int64_t> row;        ///< [nodes] first scalar of the row
  std::vector<double> value;            ///< row-major blocks

  std::size_t bytes() const;
  /// r -= A x on columns of scalars: r and x have one column per scalar, one row per right side.
  void subtract_product(const Eigen::MatrixXd& x, Eigen::MatrixXd& r) const;
};

/// C = (A0^-1)_ss by solves: fast ones in single precision, and ones in double by conjugate gradients
/// with the single factor as preconditioner (a few iterations). Const members may be called from
/// several threads at once, each with a work space of its own.
class SurfaceInverse final : public SymmetricOperator {
 public:
  struct Limits {
    std::size_t memory_limit_bytes = 0;
    unsigned threads = 2;
    std::function<void(double)> progress;
    std::function<bool()> cancelled;
  };
  /// `surface_nodes` among `free_nodes`, nodes of `a0`, both ascending.
  static Result<std::unique_ptr<SurfaceInverse>> create(const BlockMatrix& a0,
                                                        std::span<const Index> free_nodes,
                                                        std::span<const Index> surface_nodes,
                                                        const Limits& limits);

  const SingleFactor& factor() const { return *factor_; }
  std::size_t bytes() const { return factor_->bytes() + matrix_.bytes(); }
  std::size_t peak_bytes() const { return peak_bytes_; }  ///< while it was made
  /// First scalar of every surface node in elimination order.
  std::span<const std::int64_t> places() const { return places_; }

  struct Work {
    Eigen::MatrixXf x, scratch;
    Eigen::MatrixXd solution, residual, direction, product;
  };
  /// y = unit C x, unit() of the factor, on the calling thread. x and y: 3n x k, the scalars of the
  /// nodes at `places` one after another.
  void apply_single(std::span<const std::int64_t> places, FloatRef x_and_y, Work& work) const;
  /// The same in double; returns the largest relative residual of a column.
  double apply_refined(std::span<const std::int64_t> places, Eigen::Ref<Eigen::MatrixXd> x_and_y,
                       double tolerance, Work& work) const;
  /// What the last apply_refined on `work` found for all free nodes, in their order: 3 free x k.
  Eigen::MatrixXd solution_on_free_nodes(const Work& work) const;

  Index node_count() const override { return static_cast<Index>(places_.size()); }
  void apply(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::Ref<Eigen::MatrixXd> y) const override;
  /// From C^-1, a Schur complement, being no greater than A0 on the surface, and Gershgorin's theorem
  /// for blocks.
  double least_share(std::span<const Eigen::Matrix3d> scales) const override;

 private:
  SurfaceInverse() = default;
  void precondition(const Eigen::MatrixXd& residual, Eigen::MatrixXd& out, Work& work) const;

  std::unique_ptr<const SingleFactor> factor_;
  OrderedMatrix matrix_;
  std::vector<std::int64_t> places_;
  std::size_t peak_bytes_ = 0;
  unsigned threads_ = 2;
};

}  // namespace souple
