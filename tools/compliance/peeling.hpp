// SPDX-License-Identifier: GPL-3.0-or-later
// Randomised peeling (Lin, Lu, Ying 2011; Martinsson 2016): the hierarchical form of a symmetric matrix
// from products with it alone. From the root down, all blocks of a level are sampled at once: random
// vectors on the right children show the range of every block on the left children, once the levels
// above are subtracted; products with an orthonormal basis of it give the block; unit vectors at last
// give the leaves.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "formats/core/result.hpp"
#include "tools/compliance/dense_kernels.hpp"
#include "tools/compliance/hodlr_matrix.hpp"

namespace souple {

/// Columns that `apply` is given at once: wide enough for dense products at full speed, narrow enough
/// for the memory.
inline constexpr Eigen::Index peeling_columns = 64;

struct PeelingProblem {
  Index node_count = 0;
  int depth = 0;
  /// x := A x for columns of 3 node_count scalars in cluster order; called from several threads at
  /// once, each with a number of its own. False: stop.
  std::function<bool(FloatRef x, unsigned worker)> apply;
};

struct PeelingOptions {
  /// Whether an error is bounded by its largest singular value or by the root of the sum of their
  /// squares.
  bool frobenius = false;
  /// Sampling of a block ends when fresh random vectors find less than this outside its basis; a
  /// Frobenius bound is that of the whole matrix and is shared out among the blocks.
  double sampled_bound = 0;
  double truncated_bound = 0;  ///< singular values below are dropped, in the same sense
  /// Root mean square of the rounding errors of a product with signs: sampling does not go below them.
  double noise = 0;
  unsigned threads = 2;                           ///< the bits do not depend on it
  std::size_t memory_limit_bytes = 0;             ///< of the result and what it takes beside it
  std::function<void(double fraction)> progress;  ///< may be empty; called from the calling thread
};

struct PeeledMatrix {
  std::vector<LowRankBlock> blocks;     ///< heap order, as in HodlrMatrix
  std::vector<Eigen::MatrixXf> leaves;  ///< symmetric
  std::int64_t products = 0;            ///< columns that `apply` was given
  std::size_t planned_bytes = 0;        ///< largest amount that was expected to be held at once
  std::vector<Index> sampled_rank;      ///< [depth] largest of each level, before truncation
};

/// Issues: interrupted (apply said so), compliance_out_of_memory (before a round of sampling would need
/// too much), compliance_tolerance_missed (products were not finite).
Result<PeeledMatrix> peel(const PeelingProblem& problem, const PeelingOptions& options);

/// Which children of the clusters of a level hold values: x none but the `from` ones, y is asked for on
/// the `to` ones (0 left, 1 right; -1: all).
struct ActiveChildren {
  int from = -1, to = -1;
};

/// y += factor (the blocks of the first `level_count` levels) x, columns in cluster order; `active`
/// counts the children of the level after those.
void add_levels(const PeeledMatrix& matrix, Index node_count, int level_count, float factor,
                const ConstFloatRef& x, FloatRef y, ActiveChildren active = {});

}  // namespace souple
