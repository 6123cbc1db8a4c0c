// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

#include "tools/compliance/hodlr_matrix.hpp"
#include "tools/compliance/quantised_matrix.hpp"
#include "tools/compliance/worker_pool.hpp"

namespace souple {

/// S C~ S^T, as sampled or as its integers say (before the shift), multiplied piece by piece in double:
/// nothing of the size of the matrix is held beside it. Rows in cluster order.
class HodlrView {
 public:
  /// `quantised` nullptr: as sampled. Everything must outlive the view.
  HodlrView(const HodlrMatrix& matrix, const QuantisedMatrix* quantised, WorkerPool& pool);

  Eigen::Index size() const { return 3 * Eigen::Index(matrix_.order.size()); }
  /// y += factor S C~ S^T x; 3n x k. The bits do not depend on the threads.
  void add_product(double factor, const Eigen::MatrixXd& x, Eigen::MatrixXd& y) const;
  /// Norms of the columns.
  Eigen::VectorXd column_norms() const;
  /// The leaf with its scales; symmetric.
  Eigen::MatrixXd scaled_leaf(std::size_t leaf) const;

 private:
  /// Rows of a side of one block: an item of the parallel loops.
  struct Piece {
    std::size_t side = 0;               ///< within the level; the left one of block b is 2 b
    Eigen::Index first = 0, count = 0;  ///< rows within the side
    Eigen::Index begin = 0;             ///< in cluster order
  };
  struct Level {
    std::size_t first_block = 0;
    std::vector<Piece> pieces;            ///< side by side
    std::vector<std::size_t> side_begin;  ///< [sides + 1] pieces
  };

  Level make_level(int level) const;
  ClusterRange leaf_range(std::size_t leaf) const;
  Eigen::MatrixXd plain_rows(const Level& level, const Piece& piece) const;
  Eigen::MatrixXd scaled_rows(const Level& level, const Piece& piece) const;
  Eigen::VectorXd middle(std::size_t block) const;
  void add_blocks(double factor, const Eigen::Ref<const Eigen::MatrixXd>& x,
                  Eigen::Ref<Eigen::MatrixXd> y) const;
  void add_squares(const Level& level, Eigen::VectorXd& squares) const;
  /// x := S^T x, or S x.
  void scale(bool transposed, Eigen::Ref<Eigen::MatrixXd> rows, Eigen::Index begin) const;

  const HodlrMatrix& matrix_;
  const QuantisedMatrix* quantised_;
  WorkerPool& pool_;
  std::vector<Eigen::Matrix3d> scales_;  ///< L_a by position
  std::vector<Level> levels_;            ///< [depth]
};

}  // namespace souple
