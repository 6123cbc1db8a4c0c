// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "formats/core/contact_problem.hpp"
#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// A sparse W of 3x3 blocks as a ContactOperator in double precision. W may be unsymmetric: its columns
/// are what is read.
class BlockSparseOperator {
 public:
  /// Borrows `free_gap` (3m).
  BlockSparseOperator(const BlockColumns& delassus, std::span<const double> free_gap);

  std::size_t size() const { return begin_.size() - 1; }
  Mat3 diagonal_block(std::size_t i) const;  ///< 0 if there is none
  void start(std::span<const double> force);
  Vec3 gap(std::size_t i) const { return Eigen::Map<const Vec3>(&gap_[lanes * i]); }
  void add_influence(std::size_t i, const Vec3& force_change);

  /// visit(block row, block) for every block of block column i.
  template <class Visit>
  void for_each_block(std::size_t i, const Visit& visit) const {
    for (std::size_t b = begin_[i]; b < begin_[i + 1]; ++b)
      visit(std::size_t(row_[b]),
            Mat3(Eigen::Map<const Mat3, 0, Eigen::OuterStride<lanes>>(&value_[3 * lanes * b])));
  }

 private:
  static constexpr std::size_t lanes = 4;  // rows of a block with their padding

  std::span<const double> free_gap_;
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> row_;
  std::vector<double> value_;  ///< blocks of 4x3, column-major, the fourth row 0
  std::vector<double> gap_;    ///< 4 per contact
};

}  // namespace souple
