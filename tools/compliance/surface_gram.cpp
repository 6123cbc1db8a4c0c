// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/surface_gram.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <numeric>
#include <string>
#include <type_traits>
#include <utility>

#include "tools/compliance/blas_calls.hpp"
#include "tools/compliance/supernode_tree.hpp"

namespace souple {
namespace {

// Single precision: values of Y below this, where one is the typical size of a pivot's inverse root,
// are zero. They cannot be seen in C, and their products would be denormal numbers, which are slow.
constexpr float negligible = 1e-18F;

/// The chosen scalars in elimination order, and which of them stand below every supernode.
struct Columns {
  std::vector<std::int64_t> position;    ///< ascending; one per chosen node: its first scalar
  std::vector<std::int64_t> begin, end;  ///< [supernodes] scalars chosen in the subtree
  std::vector<std::int64_t> own_begin;   ///< [supernodes] of them, the first in the supernode itself

  std::int64_t count(std::size_t s) const { return end[s] - begin[s]; }
};

Columns order_columns(const SupernodeView& view, const SupernodeTree& tree,
                      std::span<const Index> chosen) {
  Columns columns;
  for (const Index node : chosen) columns.position.push_back(view.position_of_node[std::size_t(node)]);
  std::ranges::sort(columns.position);
  const auto chosen_before = [&](std::int64_t position) {
    return 3 * (std::ranges::lower_bound(columns.position, position) - columns.position.begin());
  };
  for (std::size_t s = 0; s < view.count(); ++s) {
    columns.own_begin.push_back(chosen_before(view.first_column[s]));
    columns.end.push_back(chosen_before(view.first_column[s + 1]));
    columns.begin.push_back(columns.own_begin[std::size_t(tree.first_descendant[s])]);
  }
  return columns;
}

/// log2 of the middle of the pivots' range, which Y's and C's scalars are measured by.
int pivot_exponent(const SupernodeView& view) {
  double least = INFINITY, most = 0;
  for (std::size_t s = 0; s < view.count(); ++s)
    for (std::int64_t k = 0; k < view.columns(s); ++k) {
      const double pivot = view.value[std::size_t(view.value_begin[s] + k * (view.rows(s) + 1))];
      least = std::min(least, pivot);
      most = std::max(most, pivot);
    }
  return int(std::lround(0.5 * (std::log2(least) + std::log2(most))));
}

template <class Scalar>
using Buffer = std::unique_ptr<Scalar[]>;

template <class Scalar>
Buffer<Scalar> uninitialised(std::int64_t size) {
  return std::make_unique_for_overwrite<Scalar[]>(std::size_t(size));
}

/// The forward solve from the leaves up, and the products of what it leaves.
template <class Scalar>
class ForwardWalk {
 public:
  static constexpr std::int64_t tile = SurfaceGram<Scalar>::tile_scalars;

  ForwardWalk(const SupernodeView& view, const SupernodeTree& tree, const Columns& columns,
              std::vector<Buffer<Scalar>>& tiles)
      : view_(view), tree_(tree), columns_(columns), tiles_(tiles), update_(view.count()) {
    exponent_ = std::is_same_v<Scalar, float> ? pivot_exponent(view) : 0;
  }

  /// C is this times the tiles.
  double unit() const { return std::ldexp(1.0, -2 * exponent_); }

  bool run(WorkerPool& pool, const GramOptions& options) {
    return walk_tree(tree_, pool, {costs(), options.progress, options.cancelled},
                     [&](std::size_t s, unsigned, const Pieces& pieces) { work(s, pieces); });
  }

  static double solve_flops(const SupernodeView& view, const Columns& columns, std::size_t s) {
    const double n = double(view.columns(s)), m = double(view.rows(s)) - n;
    return n * (n + 2 * m) * double(columns.count(s));
  }
  static double product_flops(const SupernodeView& view, const Columns& columns, std::size_t s) {
    const double w = double(columns.count(s));
    return double(view.columns(s)) * w * w;
  }
  std::vector<double> costs() const {
    std::vector<double> cost(view_.count());
    for (std::size_t s = 0; s < cost.size(); ++s)
      cost[s] = solve_flops(view_, columns_, s) + product_flops(view_, columns_, s);
    return cost;
  }
  double peak_bytes(unsigned threads) const {
    std::vector<double> working(view_.count()), kept(view_.count());
    for (std::size_t s = 0; s < working.size(); ++s) {
      const double w = double(columns_.count(s)), n = double(view_.columns(s));
      const double below = double(view_.rows(s)) - n;
      kept[s] = below * w * sizeof(Scalar);
      working[s] = kept[s] + n * (w + (w > 0 ? double(view_.rows(s)) : 0)) * sizeof(Scalar);
    }
    return peak_of_walk(tree_, costs(), threads, working, kept);
  }

 private:
  /// One supernode: its piece of L, its rows of Y, and the update that its parent will add.
  struct Front {
    std::size_t s;
    std::int64_t n, below, width;
    const Scalar* l;
    Scalar *y, *update;
    std::vector<std::vector<std::int64_t>> places;  ///< of every child's rows
  };

  void work(std::size_t s, const Pieces& pieces) {
    const std::int64_t n = view_.columns(s), rows = view_.rows(s), width = columns_.count(s);
    if (width == 0) return;
    const Buffer<Scalar> converted = single_factor(s), y = uninitialised<Scalar>(n * width);
    update_[s] = uninitialised<Scalar>((rows - n) * width);
    Front front{s, n, rows - n, width, factor_of(s, converted), y.get(), update_[s].get(), {}};
    for (const std::int64_t child : tree_.children[s])
      front.places.push_back(columns_.count(std::size_t(child)) > 0
                                 ? rows_in_parent(view_, std::size_t(child), s)
                                 : std::vector<std::int64_t>{});
    const std::int64_t panel = std::clamp<std::int64_t>(width / 16, 48, 256);
    pieces(std::size_t((width + panel - 1) / panel), [&](std::size_t piece) {
      const std::int64_t first = std::int64_t(piece) * panel;
      solve_panel(front, first, std::min(panel, width - first));
    });
    for (const std::int64_t child : tree_.children[s]) update_[std::size_t(child)].reset();
    add_products(front, pieces);
  }

  Buffer<Scalar> single_factor(std::size_t s) const {
    if constexpr (std::is_same_v<Scalar, double>) return nullptr;
    const std::int64_t size = view_.rows(s) * view_.columns(s);
    Buffer<Scalar> copy = uninitialised<Scalar>(size);
    const double* from = view_.value.data() + view_.value_begin[s];
    const double scale = std::ldexp(1.0, -exponent_);
    for (std::int64_t k = 0; k < size; ++k) copy[std::size_t(k)] = Scalar(scale * from[k]);
    return copy;
  }
  const Scalar* factor_of(std::size_t s, const Buffer<Scalar>& converted) const {
    if constexpr (std::is_same_v<Scalar, double>) return view_.value.data() + view_.value_begin[s];
    return converted.get();
  }

  // Columns [first, first + count) of the front: assembled, solved for the own rows, and carried down.
  void solve_panel(const Front& f, std::int64_t first, std::int64_t count) {
    Scalar *y = f.y + first * f.n, *update = f.update + first * f.below;
    std::fill_n(y, count * f.n, Scalar(0));
    std::fill_n(update, count * f.below, Scalar(0));
    const auto& children = tree_.children[f.s];
    for (std::size_t k = 0; k < children.size(); ++k)
      add_child(f, k, std::size_t(children[k]), first, first + count);
    const std::int64_t own = columns_.own_begin[f.s] - columns_.begin[f.s];
    for (std::int64_t column = std::max(first, own); column < first + count; ++column) {
      const std::int64_t chosen = columns_.begin[f.s] + column;
      const std::int64_t row = columns_.position[std::size_t(chosen / 3)] + chosen % 3;
      f.y[column * f.n + row - view_.first_column[f.s]] = 1;
    }
    blas::solve_lower(f.n, count, f.l, f.n + f.below, y, f.n);
    if (f.below > 0)
      blas::subtract_product(f.below, count, f.n, f.l + f.n, f.n + f.below, y, f.n, update, f.below);
  }

  // A column of the front stems from one child alone: its update is copied, not added.
  void add_child(const Front& f, std::size_t k, std::size_t child, std::int64_t first,
                 std::int64_t last) {
    const std::int64_t shift = columns_.begin[child] - columns_.begin[f.s];
    const std::int64_t begin = std::max(first, shift);
    const std::int64_t end = std::min(last, shift + columns_.count(child));
    const std::vector<std::int64_t>& places = f.places[k];
    const auto size = std::int64_t(places.size());
    const std::int64_t in_own = std::ranges::lower_bound(places, f.n) - places.begin();
    for (std::int64_t column = begin; column < end; ++column) {
      const Scalar* from = update_[child].get() + (column - shift) * size;
      Scalar *y = f.y + column * f.n, *update = f.update + column * f.below - f.n;
      for (std::int64_t i = 0; i < in_own; ++i) y[places[std::size_t(i)]] = cleaned(from[i]);
      for (std::int64_t i = in_own; i < size; ++i) update[places[std::size_t(i)]] = cleaned(from[i]);
    }
  }
  static Scalar cleaned(Scalar value) {
    if constexpr (std::is_same_v<Scalar, double>) return value;
    return std::abs(value) < negligible ? Scalar(0) : value;
  }

  // Y^T Y of the front's rows onto the tiles that its columns meet.
  void add_products(const Front& f, const Pieces& pieces) {
    const std::int64_t begin = columns_.begin[f.s], end = columns_.end[f.s];
    const std::int64_t low = begin / tile, count = (end + tile - 1) / tile - low;
    pieces(std::size_t(count * (count + 1) / 2), [&](std::size_t piece) {
      std::int64_t i = 0, j = std::int64_t(piece);
      while (j > i) j -= ++i;
      i += low;
      j += low;
      const std::int64_t row = std::max(begin, i * tile), rows = std::min(end, (i + 1) * tile) - row;
      const std::int64_t column = std::max(begin, j * tile);
      const std::int64_t columns = std::min(end, (j + 1) * tile) - column;
      Scalar* c = tiles_[std::size_t(i * (i + 1) / 2 + j)].get() + (column - j * tile) * tile +
                  (row - i * tile);
      const Scalar* left = f.y + (row - begin) * f.n;
      if (i == j)
        blas::add_gram(rows, f.n, left, f.n, c, tile);
      else
        blas::add_transposed_product(rows, columns, f.n, left, f.n, f.y + (column - begin) * f.n, f.n,
                                     c, tile);
    });
  }

  const SupernodeView& view_;
  const SupernodeTree& tree_;
  const Columns& columns_;
  std::vector<Buffer<Scalar>>& tiles_;
  std::vector<Buffer<Scalar>> update_;  ///< [supernodes] rows below x columns of the subtree
  int exponent_ = 0;
};

Issue out_of_memory(double needed, std::size_t limit, std::size_t nodes) {
  return make_issue(IssueCode::compliance_out_of_memory,
                    "the dense compliance of " + std::to_string(nodes) + " nodes needs " +
                        std::to_string(std::llround(needed / 1e6)) + " MB, allowed are " +
                        std::to_string(limit / 1000000) + " MB");
}

}  // namespace

template <class Scalar>
Result<std::unique_ptr<SurfaceGram<Scalar>>> SurfaceGram<Scalar>::create(
    const SupernodalFactor& factor, std::span<const Index> chosen, const GramOptions& options) try {
  blas::use_one_thread_per_call();
  const SupernodeView view = factor.view();
  const SupernodeTree tree = build_tree(view);
  const Columns columns = order_columns(view, tree, chosen);
  std::unique_ptr<SurfaceGram> gram(new SurfaceGram);
  gram->size_ = 3 * std::int64_t(chosen.size());
  for (const Index node : chosen)
    gram->place_.push_back(Index(
        3 * (std::ranges::lower_bound(columns.position, view.position_of_node[std::size_t(node)]) -
             columns.position.begin())));
  const std::int64_t along = (gram->size_ + tile_scalars - 1) / tile_scalars;
  gram->tiles_.resize(std::size_t(along * (along + 1) / 2));
  ForwardWalk<Scalar> walk(view, tree, columns, gram->tiles_);
  gram->unit_ = walk.unit();
  for (std::size_t s = 0; s < view.count(); ++s) {
    gram->report_.solve_flops += walk.solve_flops(view, columns, s);
    gram->report_.product_flops += walk.product_flops(view, columns, s);
  }
  const double needed =
      double(factor.bytes()) + double(gram->bytes()) + walk.peak_bytes(options.threads);
  if (needed > double(options.memory_limit_bytes))
    return out_of_memory(needed, options.memory_limit_bytes, chosen.size());
  gram->report_.planned_bytes = std::size_t(needed);
  WorkerPool pool(options.threads);
  pool.run(gram->tiles_.size(), [&](std::size_t k, unsigned) {
    gram->tiles_[k] = std::make_unique<Scalar[]>(std::size_t(tile_scalars) * tile_scalars);
  });
  if (!walk.run(pool, options)) return make_issue(IssueCode::interrupted, "the compliance was stopped");
  return gram;
} catch (const std::bad_alloc&) {
  return make_issue(IssueCode::compliance_out_of_memory, "the dense compliance ran out of memory");
}

template <class Scalar>
std::size_t SurfaceGram<Scalar>::bytes() const {
  return tiles_.size() * std::size_t(tile_scalars) * tile_scalars * sizeof(Scalar);
}

template <class Scalar>
template <class Out>
void SurfaceGram<Scalar>::read_as(std::span<const Index> rows, std::span<const Index> columns,
                                  Out& out) const {
  using Value = typename Out::Scalar;
  const auto at = [&](std::int64_t i, std::int64_t j) {
    if (i < j) std::swap(i, j);
    const std::int64_t ti = i / tile_scalars, tj = j / tile_scalars;
    return tiles_[std::size_t(ti * (ti + 1) / 2 + tj)].get() + (j % tile_scalars) * tile_scalars +
           i % tile_scalars;
  };
  for (std::size_t b = 0; b < columns.size(); ++b)
    for (std::size_t a = 0; a < rows.size(); ++a) {
      const std::int64_t i = place_[std::size_t(rows[a])], j = place_[std::size_t(columns[b])];
      const Scalar* first = at(i, j);  // the nodes do not straddle tiles: 3 divides their size
      for (std::int64_t c = 0; c < 3; ++c)
        for (std::int64_t r = 0; r < 3; ++r) {
          const bool mirrored = i < j || (i == j && r < c);
          const Scalar value = mirrored ? first[r * tile_scalars + c] : first[c * tile_scalars + r];
          out(Eigen::Index(3 * a) + r, Eigen::Index(3 * b) + c) = Value(unit_ * double(value));
        }
    }
}

template <class Scalar>
void SurfaceGram<Scalar>::read(std::span<const Index> rows, std::span<const Index> columns,
                               Eigen::Ref<Eigen::MatrixXf> out) const {
  read_as(rows, columns, out);
}

template <class Scalar>
void SurfaceGram<Scalar>::read(std::span<const Index> rows, std::span<const Index> columns,
                               Eigen::Ref<Eigen::MatrixXd> out) const {
  read_as(rows, columns, out);
}

template <class Scalar>
void SurfaceGram<Scalar>::multiply(const Eigen::Ref<const Eigen::MatrixXd>& x,
                                   Eigen::Ref<Eigen::MatrixXd> y, unsigned threads) const {
  using Tile = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  const std::int64_t along = (size_ + tile_scalars - 1) / tile_scalars;
  Eigen::MatrixXd ordered(size_, x.cols()), result(size_, x.cols());
  for (std::size_t row = 0; row < place_.size(); ++row)
    ordered.middleRows<3>(place_[row]) = x.middleRows<3>(3 * Eigen::Index(row));
  const auto extent = [&](std::int64_t k) {
    return std::min<std::int64_t>(tile_scalars, size_ - k * tile_scalars);
  };
  WorkerPool(threads).run(std::size_t(along), [&](std::size_t item, unsigned) {
    const auto i = std::int64_t(item);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(extent(i), x.cols());
    for (std::int64_t j = 0; j < along; ++j) {
      const auto part = ordered.middleRows(j * tile_scalars, extent(j));
      const std::int64_t low = std::max(i, j), high = std::min(i, j);
      const Eigen::Map<const Tile, 0, Eigen::OuterStride<>> stored(
          tiles_[std::size_t(low * (low + 1) / 2 + high)].get(), extent(low), extent(high),
          Eigen::OuterStride<>(tile_scalars));
      const Eigen::MatrixXd block = stored.template cast<double>();
      if (i == j)
        sum.noalias() += block.template selfadjointView<Eigen::Lower>() * part;
      else if (i > j)
        sum.noalias() += block * part;
      else
        sum.noalias() += block.transpose() * part;
    }
    result.middleRows(i * tile_scalars, extent(i)) = unit_ * sum;
  });
  for (std::size_t row = 0; row < place_.size(); ++row)
    y.middleRows<3>(3 * Eigen::Index(row)) = result.middleRows<3>(place_[row]);
}

template class SurfaceGram<float>;
template class SurfaceGram<double>;

void FactorOperator::apply(const Eigen::Ref<const Eigen::MatrixXd>& x,
                           Eigen::Ref<Eigen::MatrixXd> y) const {
  SupernodalFactor::Workspace workspace(factor_, std::size_t(x.cols()));
  const auto right_sides = workspace.right_sides();
  const auto size = Eigen::Index(factor_.size());
  if (right_sides.empty()) throw std::bad_alloc();
  Eigen::Map<Eigen::MatrixXd> f(right_sides.data(), size, x.cols());
  f.setZero();
  for (std::size_t row = 0; row < chosen_.size(); ++row)
    f.middleRows<3>(3 * Eigen::Index(chosen_[row])) = x.middleRows<3>(3 * Eigen::Index(row));
  const auto solution = factor_.solve(workspace, std::size_t(x.cols()));
  if (solution.empty()) throw std::bad_alloc();
  const Eigen::Map<const Eigen::MatrixXd> u(solution.data(), size, x.cols());
  for (std::size_t row = 0; row < chosen_.size(); ++row)
    y.middleRows<3>(3 * Eigen::Index(row)) = u.middleRows<3>(3 * Eigen::Index(chosen_[row]));
}

}  // namespace souple
