// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tools/compliance/dense_kernels.hpp"
#include "tools/compliance/supernodal_factor.hpp"

namespace souple {

/// A copy of a supernodal Cholesky factor in single precision, for many right sides at once:
/// A = unit() P^T L L^T P. Where right sides and solutions matter on some scalars only, the supernodes
/// whose subtrees hold none of them are skipped.
class SingleFactor {
 public:
  /// `wanted`: positions (in elimination order) of the scalars that matter.
  SingleFactor(const SupernodeView& view, std::span<const std::int64_t> wanted);
  static std::size_t bytes_of(const SupernodeView& view);

  std::int64_t size() const { return first_column_.back(); }  ///< scalars
  std::size_t bytes() const { return bytes_; }
  double unit() const { return unit_; }  ///< a power of four

  enum class Reach { wanted, everything };
  /// x := (L L^T)^-1 x. `x`: columns x size(), a scalar's values side by side, by elimination order.
  void solve(Eigen::MatrixXf& x, Reach reach, Eigen::MatrixXf& scratch) const;

  std::size_t count() const { return parent_.size(); }  ///< supernodes
  std::int64_t parent(std::size_t s) const { return parent_[s]; }
  bool reached(std::size_t s) const { return reached_[s]; }
  std::int64_t first_column(std::size_t s) const { return first_column_[s]; }
  std::int64_t columns(std::size_t s) const { return first_column_[s + 1] - first_column_[s]; }
  /// Positions of all rows of the supernode, its own columns first.
  std::span<const std::int32_t> rows(std::size_t s) const {
    return {row_.data() + row_begin_[s], row_.data() + row_begin_[s + 1]};
  }
  std::int64_t below(std::size_t s) const { return row_begin_[s + 1] - row_begin_[s] - columns(s); }
  FloatView diagonal_block(std::size_t s) const;  ///< lower triangle
  FloatView block_below(std::size_t s) const;

 private:
  void find_reach(std::span<const std::int64_t> wanted);

  std::vector<std::int64_t> first_column_, row_begin_, value_begin_, parent_;
  std::vector<std::int32_t> row_;
  std::vector<bool> reached_;
  std::unique_ptr<float[]> value_;
  std::size_t bytes_ = 0;
  double unit_ = 1;
};

}  // namespace souple
