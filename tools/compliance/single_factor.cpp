// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/single_factor.hpp"

#include <algorithm>
#include <cmath>

#include "tools/compliance/supernode_tree.hpp"

namespace souple {
namespace {

// The power of four next to the mean (of logarithms) of L's squared diagonal: whatever the units of
// the body, single precision then stays far from its limits.
double unit_of(const SupernodeView& view) {
  double sum = 0;
  for (std::size_t s = 0; s < view.count(); ++s)
    for (std::int64_t c = 0; c < view.columns(s); ++c)
      sum += std::log2(std::abs(view.value[std::size_t(view.value_begin[s] + c * (view.rows(s) + 1))]));
  const double count = double(std::max<std::int64_t>(view.first_column.back(), 1));
  return std::ldexp(1.0, 2 * int(std::lround(sum / count)));
}

}  // namespace

std::size_t SingleFactor::bytes_of(const SupernodeView& view) {
  return view.value.size() * sizeof(float) + view.row.size() * sizeof(std::int32_t);
}

SingleFactor::SingleFactor(const SupernodeView& view, std::span<const std::int64_t> wanted)
    : first_column_(view.first_column.begin(), view.first_column.end()),
      row_begin_(view.row_begin.begin(), view.row_begin.end()),
      value_begin_(view.value_begin.begin(), view.value_begin.end()),
      parent_(build_tree(view).parent),
      row_(view.row.size()),
      value_(std::make_unique_for_overwrite<float[]>(view.value.size())),
      bytes_(bytes_of(view)),
      unit_(unit_of(view)) {
  std::ranges::transform(view.row, row_.begin(), [](std::int64_t row) { return std::int32_t(row); });
  const double factor = 1 / std::sqrt(unit_);
  for (std::size_t k = 0; k < view.value.size(); ++k) value_[k] = float(factor * view.value[k]);
  find_reach(wanted);
  use_one_blas_thread();
}

void SingleFactor::find_reach(std::span<const std::int64_t> wanted) {
  std::vector<bool> is_wanted(std::size_t(size()), false);
  for (const std::int64_t position : wanted) is_wanted[std::size_t(position)] = true;
  reached_.assign(count(), false);
  for (std::size_t s = 0; s < count(); ++s) {
    for (std::int64_t c = first_column_[s]; c < first_column_[s + 1]; ++c)
      if (is_wanted[std::size_t(c)]) reached_[s] = true;
    if (reached_[s] && parent_[s] >= 0) reached_[std::size_t(parent_[s])] = true;
  }
}

FloatView SingleFactor::diagonal_block(std::size_t s) const {
  const std::int64_t stride = row_begin_[s + 1] - row_begin_[s];
  return {value_.get() + value_begin_[s], columns(s), columns(s), Eigen::OuterStride<>(stride)};
}

FloatView SingleFactor::block_below(std::size_t s) const {
  const std::int64_t stride = row_begin_[s + 1] - row_begin_[s];
  return {value_.get() + value_begin_[s] + columns(s), below(s), columns(s),
          Eigen::OuterStride<>(stride)};
}

void SingleFactor::solve(Eigen::MatrixXf& x, Reach reach, Eigen::MatrixXf& scratch) const {
  const Eigen::Index k = x.rows();
  const auto skipped = [&](std::size_t s) { return reach == Reach::wanted && !reached_[s]; };
  const auto own_part = [&](std::size_t s) {
    return FloatSpan(x.data() + k * first_column_[s], k, columns(s), Eigen::OuterStride<>(k));
  };
  const auto work_part = [&](std::size_t s) {
    if (scratch.rows() != k || scratch.cols() < below(s)) scratch.resize(k, below(s));
    return FloatSpan(scratch.data(), k, below(s), Eigen::OuterStride<>(k));
  };
  for (std::size_t s = 0; s < count(); ++s) {
    if (skipped(s)) continue;
    FloatSpan own = own_part(s);
    solve_right(diagonal_block(s), true, own);
    if (below(s) == 0) continue;
    FloatSpan update = work_part(s);
    update.setZero();
    add_product_transposed(1, own, block_below(s), update);
    const auto targets = rows(s).subspan(std::size_t(columns(s)));
    for (std::size_t i = 0; i < targets.size(); ++i) x.col(targets[i]) -= update.col(Eigen::Index(i));
  }
  for (std::size_t s = count(); s-- > 0;) {
    if (skipped(s)) continue;
    FloatSpan own = own_part(s);
    if (below(s) > 0) {
      FloatSpan above = work_part(s);
      const auto sources = rows(s).subspan(std::size_t(columns(s)));
      for (std::size_t i = 0; i < sources.size(); ++i) above.col(Eigen::Index(i)) = x.col(sources[i]);
      add_product(-1, above, block_below(s), own);
    }
    solve_right(diagonal_block(s), false, own);
  }
}

}  // namespace souple
