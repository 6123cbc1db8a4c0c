// SPDX-License-Identifier: GPL-3.0-or-later
// Low-rank blocks of a dense compliance by the randomised range finder (Halko, Martinsson, Tropp 2011,
// algorithm 4.4 with one power iteration), in single precision.
#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <string>

#include "tools/compliance/dense_kernels.hpp"
#include "tools/compliance/hierarchical_encoder.hpp"
#include "tools/compliance/node_scale.hpp"
#include "tools/compliance/worker_pool.hpp"

namespace souple {
namespace {

using Eigen::MatrixXf;

constexpr Eigen::Index first_rank = 40, spare_columns = 10;

MatrixXf random_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  MatrixXf m(rows, columns);
  for (Eigen::Index k = 0; k < m.size(); ++k) m.data()[k] = normal(random);
  return m;
}

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

// Orthonormal columns that span nearly the range of the leading `columns` singular vectors.
bool find_range(const MatrixXf& block, Eigen::Index columns, unsigned seed, MatrixXf& range) {
  MatrixXf r;
  range = product(block, random_matrix(block.cols(), columns, seed));
  if (!orthonormalise(range, r)) return false;
  MatrixXf dual = transposed_product(block, range);
  if (!orthonormalise(dual, r)) return false;
  range = product(block, dual);
  return orthonormalise(range, r);
}

// The terms with singular values above `cut`; more and more columns until the last one falls below it.
bool low_rank(const MatrixXf& block, float cut, unsigned seed, LowRankBlock& out) {
  const Eigen::Index largest = std::min(block.rows(), block.cols());
  for (Eigen::Index rank = first_rank;; rank *= 2) {
    const Eigen::Index columns = std::min(rank + spare_columns, largest);
    MatrixXf range, core;
    if (!find_range(block, columns, seed, range)) return false;
    // block ~ range (block^T range)^T = range core^T dual^T.
    MatrixXf dual = transposed_product(block, range);
    if (!orthonormalise(dual, core)) return false;
    const SmallSvd svd = singular_values(core.transpose().cast<double>());
    if (!svd.converged) return false;
    Eigen::Index kept = 0;
    while (kept < columns && svd.singular[kept] > double(cut)) ++kept;
    if (kept > columns - spare_columns && columns < largest) continue;
    out.left = product(range, svd.left.leftCols(kept).cast<float>());
    out.right = product(dual, svd.right.leftCols(kept).cast<float>());
    out.singular = svd.singular.head(kept).cast<float>();
    return true;
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
  std::atomic<bool> ok{true};
  std::atomic<std::size_t> done{0};
  pool.run(items.size(), [&](std::size_t k, unsigned worker) {
    const Item& item = items[k];
    const Eigen::MatrixXf block = scaled_block(source, matrix, item);
    const float cut =
        scaling->entry_error * 0.25F * std::sqrt(float(std::max(block.rows(), block.cols())));
    if (item.is_leaf)
      matrix.leaves[item.block] = 0.5F * (block + block.transpose());
    else if (!block.allFinite() ||
             !low_rank(block, cut, unsigned(item.block), matrix.blocks[item.block]))
      ok = false;
    const std::size_t so_far = ++done;
    if (worker == 0 && options.progress) options.progress(double(so_far) / double(items.size()));
  });
  if (!ok)
    return make_issue(IssueCode::compliance_factorisation_failed,
                      "a block of the compliance could not be decomposed");
  return matrix;
}

}  // namespace souple
