// SPDX-License-Identifier: GPL-3.0-or-later
// Low-rank blocks of a dense compliance by the randomised range finder (Halko, Martinsson, Tropp 2011,
// algorithm 4.2 by blocks of columns), in single precision.
#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <random>
#include <string>

#include "tools/compliance/dense_kernels.hpp"
#include "tools/compliance/hierarchical_encoder.hpp"
#include "tools/compliance/node_scale.hpp"
#include "tools/compliance/worker_pool.hpp"

namespace souple {
namespace {

using Eigen::MatrixXf;

constexpr Eigen::Index first_columns = 32, spare_columns = 4;
constexpr float rest_share = 0.7F;
// Singular values below this share of sqrt(rows) times the expected errors of entries are left out: the
// quantisation drops them anyway.
constexpr float cut_share = 0.5F;

MatrixXf product(const MatrixXf& a, const MatrixXf& b) {
  MatrixXf c = MatrixXf::Zero(a.rows(), b.cols());
  add_product(1, a, b, c);
  return c;
}

MatrixXf transposed_product(const MatrixXf& a, const MatrixXf& b) {
  MatrixXf c = MatrixXf::Zero(a.cols(), b.cols());
  add_transposed_product(1, a, b, c);
  return c;
}

// a := (I - Q Q^T) a, Q orthonormal. Twice is enough.
void project_out(const Eigen::Ref<const MatrixXf>& q, MatrixXf& a) {
  for (int pass = 0; pass < 2 && q.cols() > 0; ++pass) {
    MatrixXf inside = MatrixXf::Zero(q.cols(), a.cols());
    add_transposed_product(1, q, a, inside);
    add_product(-1, q, inside, a);
  }
}

/// Orthonormal columns that come nearer and nearer to spanning the range of a block.
class RangeFinder {
 public:
  RangeFinder(const MatrixXf& block, unsigned seed) : block_(block), random_(seed) {}

  Eigen::Index columns() const { return range_.cols(); }
  const MatrixXf& range() const { return range_; }

  // About so many more columns; about the Frobenius norm of what the range left over before them.
  std::optional<float> extend(Eigen::Index wanted) {
    const Eigen::Index largest = std::min(block_.rows(), block_.cols());
    const Eigen::Index count = std::min(wanted, largest - columns());
    MatrixXf fresh = product(block_, random_columns(count)), r;
    project_out(range_, fresh);
    const float rest = fresh.norm() / std::sqrt(float(std::max<Eigen::Index>(count, 1)));
    if (!orthonormalise(fresh, r)) return std::nullopt;
    // Columns that were nearly inside have lost their angle to the range in rounding.
    project_out(range_, fresh);
    if (!orthonormalise(fresh, r)) return std::nullopt;
    const Eigen::Index known = columns();
    range_.conservativeResize(block_.rows(), known + count);
    range_.rightCols(count) = fresh;
    return rest;
  }

 private:
  MatrixXf random_columns(Eigen::Index columns) {
    MatrixXf m(block_.cols(), columns);
    for (Eigen::Index k = 0; k < m.size(); ++k) m.data()[k] = normal_(random_);
    return m;
  }

  const MatrixXf& block_;
  std::mt19937 random_;
  std::normal_distribution<float> normal_;
  MatrixXf range_{block_.rows(), 0};
};

// The terms with singular values above `cut` of what the range spans; false if not computed.
bool terms_within(const MatrixXf& block, const MatrixXf& range, float cut, LowRankBlock& out) {
  // block ~ range (block^T range)^T = range core^T dual^T.
  MatrixXf dual = transposed_product(block, range), core;
  if (!orthonormalise(dual, core)) return false;
  const SmallSvd svd = singular_values(core.transpose().cast<double>());
  if (!svd.converged) return false;
  Eigen::Index kept = 0;
  while (kept < svd.singular.size() && svd.singular[kept] > double(cut)) ++kept;
  out.left = product(range, svd.left.leftCols(kept).cast<float>());
  out.right = product(dual, svd.right.leftCols(kept).cast<float>());
  out.singular = svd.singular.head(kept).cast<float>();
  return true;
}

// The terms with singular values above `cut`. What the range leaves over has singular values that fall
// slowly: about as many as the range has columns count, so that its norm is their root times the cut
// where the largest is near the cut.
bool low_rank(const MatrixXf& block, float cut, unsigned seed, LowRankBlock& out) {
  const Eigen::Index largest = std::min(block.rows(), block.cols());
  RangeFinder finder(block, seed);
  for (bool enough = false;;) {
    while (!enough && finder.columns() < largest) {
      const auto rest = finder.extend(std::max(first_columns, finder.columns() / 4));
      if (!rest) return false;
      enough = *rest < rest_share * cut * std::sqrt(float(finder.columns()));
    }
    if (!terms_within(block, finder.range(), cut, out)) return false;
    enough = out.singular.size() + spare_columns <= finder.columns();
    if (enough || finder.columns() == largest) return true;
  }
}

/// One block of the tree, or one leaf: an item of the parallel loop.
struct Item {
  ClusterRange rows, columns;
  std::size_t block = 0;
  bool is_leaf = false;
};

std::vector<Item> make_items(Index node_count, int depth) {
  std::vector<Item> items;
  for (int d = 0; d < depth; ++d)
    for (Index i = 0; i < (Index{1} << d); ++i)
      items.push_back({cluster_range(node_count, d + 1, 2 * i),
                       cluster_range(node_count, d + 1, 2 * i + 1), std::size_t(block_of_cluster(d, i)),
                       false});
  for (Index leaf = 0; leaf < (Index{1} << depth); ++leaf) {
    const ClusterRange range = cluster_range(node_count, depth, leaf);
    items.push_back({range, range, std::size_t(leaf), true});
  }
  return items;
}

MatrixXf scaled_block(const SymmetricSource& source, const HodlrMatrix& matrix, const Item& item) {
  const std::span order(matrix.order);
  const auto rows = order.subspan(std::size_t(item.rows.begin), std::size_t(item.rows.size()));
  const auto columns = order.subspan(std::size_t(item.columns.begin), std::size_t(item.columns.size()));
  MatrixXf block(3 * Eigen::Index(rows.size()), 3 * Eigen::Index(columns.size()));
  source.read(rows, columns, block);
  for (std::size_t a = 0; a < rows.size(); ++a)
    scale_matrix<float>(matrix.scale[std::size_t(rows[a])])
        .triangularView<Eigen::Lower>()
        .solveInPlace(block.middleRows<3>(3 * Eigen::Index(a)));
  for (std::size_t b = 0; b < columns.size(); ++b)
    scale_matrix<float>(matrix.scale[std::size_t(columns[b])])
        .transpose()
        .triangularView<Eigen::Upper>()
        .solveInPlace<Eigen::OnTheRight>(block.middleCols<3>(3 * Eigen::Index(b)));
  return block;
}

}  // namespace

Result<HodlrMatrix> compress_dense(const SymmetricSource& source, std::span<const Point> positions,
                                   const EncodeOptions& options) {
  use_one_blas_thread();
  WorkerPool pool(options.threads);
  const Index count = source.node_count();
  HodlrMatrix matrix;
  matrix.depth = cluster_depth(count, options.leaf_nodes);
  matrix.order = cluster_order(positions);
  auto scaling = node_scaling(source, options, pool);
  if (!scaling) return scaling.issue();
  matrix.scale = std::move(scaling->scale);
  matrix.blocks.resize((std::size_t{1} << matrix.depth) - 1);
  matrix.leaves.resize(std::size_t{1} << matrix.depth);
  const std::vector<Item> items = make_items(count, matrix.depth);
  std::atomic<bool> ok{true}, cancelled{false};
  std::atomic<std::size_t> done{0};
  pool.run(items.size(), [&](std::size_t k, unsigned worker) {
    if (worker == 0 && options.cancelled && options.cancelled()) cancelled = true;
    if (cancelled) return;
    const Item& item = items[k];
    const Eigen::MatrixXf block = scaled_block(source, matrix, item);
    const float cut =
        scaling->entry_error * cut_share * std::sqrt(float(std::max(block.rows(), block.cols())));
    if (item.is_leaf)
      matrix.leaves[item.block] = 0.5F * (block + block.transpose());
    else if (!block.allFinite() ||
             !low_rank(block, cut, unsigned(item.block), matrix.blocks[item.block]))
      ok = false;
    const std::size_t so_far = ++done;
    if (worker == 0 && options.progress) options.progress(double(so_far) / double(items.size()));
  });
  // Whatever worker 0 had time to ask.
  if (cancelled || (options.cancelled && options.cancelled()))
    return make_issue(IssueCode::interrupted, "the compression was stopped");
  if (!ok)
    return make_issue(IssueCode::compliance_factorisation_failed,
                      "a block of the compliance could not be decomposed");
  return matrix;
}

}  // namespace souple
