// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/multifrontal.hpp"

#include <algorithm>
#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include "tools/compliance/blas_calls.hpp"
#include "tools/compliance/supernode_tree.hpp"

namespace souple {
namespace {

constexpr std::int64_t panel_columns = 192;  // eliminated at once
constexpr std::int64_t tile_rows = 384;      // of the products behind them
constexpr std::int64_t assembled_columns = 64;

std::int64_t pieces_of(std::int64_t size, std::int64_t piece) { return (size + piece - 1) / piece; }

/// Tile `index` of the lower block triangle, row by row.
std::pair<std::int64_t, std::int64_t> lower_tile(std::int64_t index) {
  std::int64_t row = 0;
  while (index > row) index -= ++row;
  return {row, index};
}

class Factorisation {
 public:
  Factorisation(const PermutedMatrix& matrix, const SupernodeView& view, std::span<double> values)
      : matrix_(matrix), view_(view), values_(values), tree_(build_tree(view)), update_(view.count()) {}

  Status run(const FactorOptions& options) {
    TreeWalk walk{costs(view_), options.progress, options.cancelled};
    WorkerPool pool(options.threads);
    scratch_.resize(pool.threads());
    for (auto& rows : scratch_) rows.resize(std::size_t(view_.first_column.back()));
    const bool finished = walk_tree(
        tree_, pool, walk,
        [&](std::size_t s, unsigned worker, const Pieces& pieces) { eliminate(s, worker, pieces); });
    if (!finished) return make_issue(IssueCode::interrupted, "the factorisation was stopped");
    if (failed_)
      return make_issue(IssueCode::compliance_factorisation_failed,
                        "the system matrix is not positive definite");
    return {};
  }

  static std::vector<double> costs(const SupernodeView& view) {
    std::vector<double> cost(view.count());
    for (std::size_t s = 0; s < view.count(); ++s) {
      const double n = double(view.columns(s)), m = double(view.rows(s)) - n;
      cost[s] = n * (n * n / 3 + n * m + m * m);
    }
    return cost;
  }

 private:
  void eliminate(std::size_t s, unsigned worker, const Pieces& pieces) {
    if (failed_) return;
    double* front = values_.data() + view_.value_begin[s];
    const std::int64_t n = view_.columns(s), below = view_.rows(s) - n;
    std::fill_n(front, n * view_.rows(s), 0.0);
    add_matrix(s, scratch_[worker]);
    update_[s] = std::make_unique<double[]>(std::size_t(below * below));
    for (const std::int64_t child : tree_.children[s]) {
      add_child(std::size_t(child), s, pieces);
      update_[std::size_t(child)].reset();
    }
    for (std::int64_t first = 0; first < n && !failed_; first += panel_columns)
      eliminate_panel(s, first, std::min(panel_columns, n - first), pieces);
    if (!failed_) subtract_outer(front + n, view_.rows(s), below, n, update_[s].get(), below, pieces);
  }

  // The columns of A from the diagonal down.
  void add_matrix(std::size_t s, std::vector<std::int32_t>& local) {
    const std::int64_t rows = view_.rows(s), first = view_.first_column[s];
    for (std::int64_t k = 0; k < rows; ++k)
      local[std::size_t(view_.row[std::size_t(view_.row_begin[s] + k)])] = std::int32_t(k);
    double* front = values_.data() + view_.value_begin[s];
    const BlockPattern& pattern = *matrix_.a->pattern;
    for (std::int64_t column = first; column < view_.first_column[s + 1]; column += 3) {
      const Index node = matrix_.nodes[std::size_t(matrix_.order[std::size_t(column / 3)])];
      for (Index b = pattern.row_begin[node]; b < pattern.row_begin[node + 1]; ++b) {
        const std::int64_t row = matrix_.position[std::size_t(pattern.column[std::size_t(b)])];
        if (row < column) continue;  // before it in the order, or left out
        double* target = front + (column - first) * rows + local[std::size_t(row)];
        const auto block =
            matrix_.a->block(b);  // symmetric matrix: its transpose is block (row, column)
        for (std::int64_t c = 0; c < 3; ++c)
          for (std::int64_t r = 0; r < 3; ++r) target[c * rows + r] = block(c, r);
      }
    }
  }

  void add_child(std::size_t child, std::size_t s, const Pieces& pieces) {
    const auto places = rows_in_parent(view_, child, s);
    const auto size = std::int64_t(places.size());
    const std::int64_t n = view_.columns(s), rows = view_.rows(s);
    double* front = values_.data() + view_.value_begin[s];
    double* update = update_[s].get();
    const double* from = update_[child].get();
    pieces(std::size_t(pieces_of(size, assembled_columns)), [&](std::size_t piece) {
      const std::int64_t begin = std::int64_t(piece) * assembled_columns;
      for (std::int64_t j = begin; j < std::min(size, begin + assembled_columns); ++j) {
        const std::int64_t column = places[std::size_t(j)];
        double* to = column < n ? front + column * rows : update + (column - n) * (rows - n) - n;
        for (std::int64_t i = j; i < size; ++i) to[places[std::size_t(i)]] += from[j * size + i];
      }
    });
  }

  // Right-looking: the panel's own block, the rows below it, then what is left of the own columns.
  void eliminate_panel(std::size_t s, std::int64_t first, std::int64_t columns, const Pieces& pieces) {
    const std::int64_t rows = view_.rows(s), next = first + columns;
    double* front = values_.data() + view_.value_begin[s];
    const double* diagonal = front + first * rows + first;
    if (!blas::cholesky(columns, front + first * rows + first, rows)) {
      failed_ = true;
      return;
    }
    pieces(std::size_t(pieces_of(rows - next, tile_rows)), [&](std::size_t piece) {
      const std::int64_t row = next + std::int64_t(piece) * tile_rows;
      blas::solve_lower_from_right(std::min(tile_rows, rows - row), columns, diagonal, rows,
                                   front + first * rows + row, rows);
    });
    const std::int64_t own = view_.columns(s) - next, below = view_.rows(s) - view_.columns(s);
    if (own == 0) return;
    const double* l = front + first * rows + next;
    double* rest = front + next * rows + next;
    subtract_outer(l, rows, own, columns, rest, rows, pieces);
    const std::int64_t across = pieces_of(own, tile_rows), down = pieces_of(below, tile_rows);
    pieces(std::size_t(across * down), [&](std::size_t piece) {
      const std::int64_t row = own + std::int64_t(piece) / across * tile_rows;
      const std::int64_t column = std::int64_t(piece) % across * tile_rows;
      blas::subtract_product_transposed(std::min(tile_rows, own + below - row),
                                        std::min(tile_rows, own - column), columns, l + row, rows,
                                        l + column, rows, rest + column * rows + row, rows);
    });
  }

  /// Lower triangle of C -= A A^T, A size x k.
  static void subtract_outer(const double* a, std::int64_t lda, std::int64_t size, std::int64_t k,
                             double* c, std::int64_t ldc, const Pieces& pieces) {
    const std::int64_t tiles = pieces_of(size, tile_rows);
    pieces(std::size_t(tiles * (tiles + 1) / 2), [&](std::size_t piece) {
      const auto [i, j] = lower_tile(std::int64_t(piece));
      const std::int64_t row = i * tile_rows, column = j * tile_rows;
      const std::int64_t height = std::min(tile_rows, size - row);
      double* target = c + column * ldc + row;
      if (i == j)
        blas::subtract_outer_gram(height, k, a + row, lda, target, ldc);
      else
        blas::subtract_product_transposed(height, tile_rows, k, a + row, lda, a + column, lda, target,
                                          ldc);
    });
  }

  const PermutedMatrix& matrix_;
  const SupernodeView& view_;
  std::span<double> values_;
  SupernodeTree tree_;
  std::vector<std::unique_ptr<double[]>> update_;   ///< of supernodes whose parent is not done
  std::vector<std::vector<std::int32_t>> scratch_;  ///< by worker: place of a row in the front
  std::atomic<bool> failed_{false};
};

}  // namespace

double multifrontal_bytes(const SupernodeView& view, unsigned threads) {
  const SupernodeTree tree = build_tree(view);
  std::vector<double> kept(view.count());
  for (std::size_t s = 0; s < view.count(); ++s) {
    const double below = double(view.rows(s) - view.columns(s));
    kept[s] = below * below * sizeof(double);
  }
  const double scratch = double(threads) * double(view.first_column.back()) * sizeof(std::int32_t);
  return peak_of_walk(tree, Factorisation::costs(view), threads, kept, kept) + scratch;
}

Status factorise(const PermutedMatrix& matrix, const SupernodeView& view, std::span<double> values,
                 const FactorOptions& options) {
  return Factorisation(matrix, view, values).run(options);
}

}  // namespace souple
