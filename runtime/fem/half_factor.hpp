// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/fem/block_matrix.hpp"

namespace souple {

/// The inverse of the part of a symmetric positive definite block matrix on chosen nodes, as fast to
/// apply as memory allows: a supernodal factor in half-precision floats, of which a solve reads every
/// number once or twice. Per piece of a nested dissection, with c its own nodes and r those of its
/// ancestors that it couples to: B = A_rc A_cc^-1 and S = A_cc^-1 of the matrix that is left when all
/// pieces before are eliminated. B is without unit and its entries are of order 1, so that halves lose
/// little: motions come out to about 1e-4 of the largest. Computed in double; the same on every run.
class HalfFactor {
 public:
  /// `positions`: of all nodes of the matrix, m. Returns false if the part is not positive definite.
  bool create(const BlockMatrix& a, std::span<const Point> positions, std::span<const Index> nodes);

  std::size_t size() const { return 3 * order_.size(); }  ///< scalars
  /// The nodes in the order in which solve takes and gives their values.
  std::span<const Index> order() const { return order_; }
  /// x = A^-1 x, size() entries. `work` has at least work_size() entries.
  void solve(float* x, float* work) const;
  std::size_t work_size() const { return 2 * largest_border_; }
  std::size_t bytes() const;

 private:
  struct Piece {
    Index begin = 0, end = 0;      ///< own nodes in the order
    std::size_t border_begin = 0;  ///< in border_
    std::size_t border_count = 0;
    std::size_t values_begin = 0;  ///< S by columns, then B by columns, every column a multiple of 8
    float inverse_scale = 1;       ///< S = stored times this, m/N
  };

  void forward(const Piece& piece, float* x, float* work) const;
  void backward(const Piece& piece, float* x, float* work) const;

  std::vector<Index> order_;
  std::vector<Piece> pieces_;
  std::vector<Index> border_;  ///< places in the order
  std::vector<std::uint16_t> values_;
  std::size_t largest_border_ = 0;  ///< scalars, rounded up
};

}  // namespace souple
