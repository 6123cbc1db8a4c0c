// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/fem/block_matrix.hpp"
#include "runtime/fem/integer_products.hpp"

namespace souple {

/// The inverse of the part of a symmetric positive definite block matrix on chosen nodes, as fast to
/// apply as 16 bits a number allow: a supernodal factor, of which a solve reads every number once or
/// twice. Per piece of a nested dissection, with c its own nodes and r those of its
/// ancestors that it couples to: B = A_rc A_cc^-1 and S = A_cc^-1 of the matrix that is left when all
/// pieces before are eliminated. B is without unit and its entries are of order 1; it is kept in
/// integers, whose products are the fastest, where the stiffness of the piece's nodes is about the
/// same, and in half-precision floats where it is not; S in halves. Motions come out to about 1e-4 of
/// the largest. Computed in double; the same on every run.
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
    std::size_t inverse_begin = 0;   ///< S in values_, by columns of a multiple of 16 rows
    std::size_t coupling_begin = 0;  ///< B, the same
    float inverse_scale = 1;         ///< S = stored times this, m/N
    bool in_integers = false;        ///< B
    IntegerBlock coupling;           ///< B if so, its `values` not set
  };

  void add_piece(Index begin, Index end, const std::vector<Index>& border, const Eigen::MatrixXd& s,
                 const Eigen::MatrixXd& b, bool in_integers);
  void append_half_columns(const Eigen::MatrixXd& matrix);
  IntegerBlock coupling_of(const Piece& piece) const;
  void forward(const Piece& piece, float* x, float* work) const;
  void backward(const Piece& piece, float* x, float* work) const;

  std::vector<Index> order_;
  std::vector<Piece> pieces_;
  std::vector<Index> border_;  ///< places in the order
  PackedValues values_;
  std::size_t largest_border_ = 0;  ///< scalars, rounded up
};

}  // namespace souple
