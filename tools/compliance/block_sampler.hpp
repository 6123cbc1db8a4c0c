// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "tools/compliance/dense_kernels.hpp"
#include "tools/compliance/hodlr_matrix.hpp"

namespace souple {

/// out(r, c): the sign of counter (level, column + c, first_row + r), from a hash: the same for every
/// run, order and thread.
void fill_signs(std::uint64_t level, std::uint64_t column, std::int64_t first_row,
                Eigen::Ref<Eigen::MatrixXf> out);

struct BlockBounds {
  bool frobenius = false;
  double sampled = 0, truncated = 0;
  double noise = 0;  ///< root mean square of the samples' own rounding errors
};

/// One off-diagonal block on its way from random samples to singular vectors: rounds of samples, each
/// orthogonalised against all that came before, until fresh ones find less than the bound.
class BlockSampler {
 public:
  BlockSampler() = default;
  BlockSampler(Eigen::Index rows, Eigen::Index columns, const BlockBounds& bounds)
      : rows_(rows), columns_(columns), bounds_(bounds) {}

  bool complete() const { return complete_; }
  Eigen::Index rank() const { return rank_; }
  /// Of basis and image if a round of `width` more samples is kept.
  std::size_t bytes_with(Eigen::Index width) const {
    const Eigen::Index rank = std::min(complete_ ? rank_ : rank_ + width, std::min(rows_, columns_));
    return std::size_t(rank * (rows_ + columns_)) * sizeof(float);
  }

  void begin_round(Eigen::Index width) { samples_.resize(rows_, width); }
  /// Samples [begin, begin + |part|) of the round; from several threads at once.
  void take(Eigen::Index begin, const ConstFloatRef& part);
  void end_round();

  /// False: the samples were not finite.
  bool join_basis(const PieceRunner& run);
  const Eigen::MatrixXf& basis() const { return basis_; }  ///< Q, orthonormal, rows x rank
  Eigen::MatrixXf& image() { return image_; }              ///< to be filled: (Q^T block)^T
  /// Singular values above the bound. False: they did not converge.
  bool finish(LowRankBlock& out, const PieceRunner& run);

 private:
  void project_out(FloatRef samples) const;
  double sampling_goal(Eigen::Index count) const;
  double remainder_of(const ConstFloatRef& samples) const;
  Eigen::Index kept(const Eigen::VectorXd& singular) const;

  Eigen::Index rows_ = 0, columns_ = 0, rank_ = 0;
  BlockBounds bounds_;
  bool complete_ = false;
  Eigen::MatrixXf samples_;
  std::vector<Eigen::MatrixXf> parts_;  ///< of the basis
  Eigen::MatrixXf basis_, image_;
};

}  // namespace souple
