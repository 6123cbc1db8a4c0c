// SPDX-License-Identifier: MIT
#include "runtime/fem/inverse_block.hpp"

#include <algorithm>

#include "runtime/fem/tile_products.hpp"

namespace souple {
namespace {

constexpr std::size_t tile_nodes = tile_width / 3;
constexpr std::size_t group_tiles = 4;    // two groups of tiles stay in the second cache
constexpr std::size_t chunk_depth = 128;  // two tiles of so many rows stay in the first cache

// y = L^-1 y for the own rows of a front; L by columns of `stride`.
template <std::size_t rows>
SOUPLE_KERNEL void solve_strip(const double* l, std::size_t stride, std::size_t i,
                               const double* reciprocals, double* y) {
  const TileSum<rows> known = tile_product<rows>(l + i, stride, y, tile_width, i);
  Lanes x[rows][tile_lanes];
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t v = 0; v < tile_lanes; ++v) {
      Lanes value = load_lanes(y + tile_width * (i + r) + 4 * v) - known.value[r][v];
      for (std::size_t s = 0; s < r; ++s)
        value = fnma(all_lanes(l[(i + s) * stride + i + r]), x[s][v], value);
      x[r][v] = value * all_lanes(reciprocals[i + r]);
      _mm256_storeu_pd(y + tile_width * (i + r) + 4 * v, x[r][v]);
    }
}

void solve_tile(const double* l, std::size_t stride, std::size_t own, const double* reciprocals,
                double* y) {
  for_row_strips(own,
                 [&](auto rows, std::size_t i) { solve_strip<rows()>(l, stride, i, reciprocals, y); });
}

// Rows of Y at `targets` -= L_rc y.
void subtract_border(const double* l, std::size_t stride, std::size_t own, const double* y,
                     std::span<const std::size_t> targets, double* values) {
  for_row_strips(targets.size(), [&](auto rows, std::size_t i) {
    const TileSum<rows()> sum = tile_product<rows()>(l + i, stride, y, tile_width, own);
    for (std::size_t r = 0; r < rows(); ++r)
      for (std::size_t v = 0; v < tile_lanes; ++v) {
        double* const out = values + targets[i + r] + 4 * v;
        _mm256_storeu_pd(out, load_lanes(out) - sum.value[r][v]);
      }
  });
}

// product += a^T b, all of tiles, `product` by rows.
void add_gram(const double* a, const double* b, std::size_t depth, double* product) {
  for (std::size_t k = 0; k < depth; k += chunk_depth) {
    const std::size_t count = std::min(chunk_depth, depth - k);
    for (std::size_t i = 0; i < tile_width; i += 4) {
      const auto sum =
          tile_product<4>(a + tile_width * k + i, tile_width, b + tile_width * k, tile_width, count);
      for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t v = 0; v < tile_lanes; ++v) {
          double* const out = product + tile_width * (i + r) + 4 * v;
          _mm256_storeu_pd(out, load_lanes(out) + sum.value[r][v]);
        }
    }
  }
}

}  // namespace

void InverseBlockWork::evaluate(const FrontPlan& plan, const double* panels,
                                std::span<const Index> places, std::span<const Index> chosen,
                                std::span<double> block) {
  size_ = 3 * chosen.size();
  number_columns(places, chosen);
  lay_out(plan);
  set_units(plan);
  for (std::size_t index = 0; index < plan.fronts.size(); ++index)
    if (ranges_[index].begin < ranges_[index].end)
      forward(plan, index, panels + plan.fronts[index].panel_begin);
  multiply(block);
  copy_repeated(block);
}

void InverseBlockWork::number_columns(std::span<const Index> places, std::span<const Index> chosen) {
  columns_.clear();
  repeated_.clear();
  for (std::size_t slot = 0; slot < chosen.size(); ++slot)
    columns_.push_back({places[std::size_t(chosen[slot])], Index(slot)});
  std::ranges::sort(columns_, {}, [](const Column& c) { return std::pair(c.place, c.slot); });
  std::size_t count = 0;
  for (const Column& column : columns_)
    if (count > 0 && columns_[count - 1].place == column.place)
      repeated_.push_back({columns_[count - 1].slot, column.slot});
    else
      columns_[count++] = column;
  columns_.resize(count);
}

// Which tiles every front sees, and where its rows of each stand.
void InverseBlockWork::lay_out(const FrontPlan& plan) {
  ranges_.resize(plan.fronts.size());
  segment_begin_.assign((columns_.size() + tile_nodes - 1) / tile_nodes + 1, 0);
  for (std::size_t index = 0; index < plan.fronts.size(); ++index) {
    const auto first_from = [&](Index place) {
      return std::size_t(std::ranges::lower_bound(columns_, place, {}, &Column::place) -
                         columns_.begin());
    };
    const std::size_t first = first_from(plan.fronts[index].subtree_begin);
    const std::size_t end = first_from(plan.fronts[index].end);
    ranges_[index] =
        first == end ? TileRange{}
                     : TileRange{Index(first / tile_nodes), Index((end + tile_nodes - 1) / tile_nodes)};
    for (Index t = ranges_[index].begin; t < ranges_[index].end; ++t)
      ++segment_begin_[std::size_t(t) + 1];
  }
  for (std::size_t t = 0; t < tile_count(); ++t) segment_begin_[t + 1] += segment_begin_[t];
  segments_.resize(segment_begin_.back());
  next_ = segment_begin_;
  for (std::size_t index = 0; index < plan.fronts.size(); ++index)
    for (Index t = ranges_[index].begin; t < ranges_[index].end; ++t)
      segments_[next_[std::size_t(t)]++] = {Index(index), 0, 3 * plan.fronts[index].own()};
  std::size_t scalars = 0;
  for (Segment& segment : segments_) {
    segment.begin = scalars;
    scalars += tile_width * segment.depth;
  }
  if (std::size_t(values_.size()) < scalars) values_.resize(Eigen::Index(scalars));
  std::fill_n(values_.data(), scalars, 0.0);
}

// A column begins in the front that owns its node: the first of its tile that ends after it.
void InverseBlockWork::set_units(const FrontPlan& plan) {
  for (std::size_t column = 0; column < columns_.size(); ++column) {
    const Index place = columns_[column].place;
    std::size_t s = segment_begin_[column / tile_nodes];
    while (plan.fronts[std::size_t(segments_[s].front)].end <= place) ++s;
    const auto row = std::size_t(3 * (place - plan.fronts[std::size_t(segments_[s].front)].begin));
    for (std::size_t c = 0; c < 3; ++c)
      values_[Eigen::Index(segments_[s].begin + tile_width * (row + c) + 3 * (column % tile_nodes) +
                           c)] = 1;
  }
  next_ = segment_begin_;
}

// The rows that a front's border has in the tile of `segment`; both ascend.
void InverseBlockWork::find_targets(const FrontPlan& plan, const FrontPlan::Front& front,
                                    const Segment* segment) {
  for (std::size_t b = 0; b < front.border(); ++b) {
    const Index place = plan.border[front.border_begin + b];
    while (plan.fronts[std::size_t(segment->front)].end <= place) ++segment;
    const auto row = std::size_t(3 * (place - plan.fronts[std::size_t(segment->front)].begin));
    for (std::size_t c = 0; c < 3; ++c) targets_[3 * b + c] = segment->begin + tile_width * (row + c);
  }
}

void InverseBlockWork::forward(const FrontPlan& plan, std::size_t index, const double* panel) {
  const FrontPlan::Front& front = plan.fronts[index];
  const std::size_t size = 3 * front.size(), own = 3 * front.own();
  reciprocals_.resize(own);
  for (std::size_t k = 0; k < own; ++k) reciprocals_[k] = 1 / panel[k * size + k];
  targets_.resize(size - own);
  for (auto t = std::size_t(ranges_[index].begin); t < std::size_t(ranges_[index].end); ++t) {
    const Segment& segment = segments_[next_[t]++];
    double* const y = values_.data() + segment.begin;
    solve_tile(panel, size, own, reciprocals_.data(), y);
    find_targets(plan, front, &segment);
    subtract_border(panel + own, size, own, y, targets_, values_.data());
  }
}

void InverseBlockWork::multiply(std::span<double> block) {
  const std::size_t tiles = tile_count();
  for (std::size_t group_t = 0; group_t < tiles; group_t += group_tiles)
    for (std::size_t group_s = 0; group_s <= group_t; group_s += group_tiles)
      for (std::size_t t = group_t; t < std::min(group_t + group_tiles, tiles); ++t)
        for (std::size_t s = group_s; s < std::min(group_s + group_tiles, t + 1); ++s)
          multiply_tiles(s, t, block);
}

// s <= t. What sees both tiles is a front that sees the first and reaches to the other, and all of its
// ancestors.
void InverseBlockWork::multiply_tiles(std::size_t s, std::size_t t, std::span<double> block) {
  alignas(32) double product[tile_width * tile_width] = {};
  const Segment* other = segments_.data() + segment_begin_[t];
  for (std::size_t k = segment_begin_[s]; k < segment_begin_[s + 1]; ++k) {
    const Segment& segment = segments_[k];
    if (std::size_t(ranges_[std::size_t(segment.front)].end) <= t) continue;
    while (other->front != segment.front) ++other;
    add_gram(values_.data() + segment.begin, values_.data() + other->begin, segment.depth, product);
  }
  store_tile(product, s, t, block);
}

void InverseBlockWork::store_tile(const double* product, std::size_t s, std::size_t t,
                                  std::span<double> block) const {
  const std::size_t rows = std::min(tile_nodes, columns_.size() - tile_nodes * s);
  const std::size_t cols = std::min(tile_nodes, columns_.size() - tile_nodes * t);
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = s == t ? i : 0; j < cols; ++j) {
      const auto row = 3 * std::size_t(columns_[tile_nodes * s + i].slot);
      const auto col = 3 * std::size_t(columns_[tile_nodes * t + j].slot);
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b) {
          const double value = product[tile_width * (3 * i + a) + 3 * j + b];
          block[(row + a) * size_ + col + b] = value;
          block[(col + b) * size_ + row + a] = value;
        }
    }
}

void InverseBlockWork::copy_repeated(std::span<double> block) const {
  for (const auto& [from, to] : repeated_)
    for (std::size_t c = 0; c < 3; ++c) {
      const double* const source = block.data() + (3 * std::size_t(from) + c) * size_;
      std::copy_n(source, size_, block.data() + (3 * std::size_t(to) + c) * size_);
    }
  for (const auto& [from, to] : repeated_)
    for (std::size_t row = 0; row < size_; ++row) {
      double* const entry = block.data() + row * size_;
      std::copy_n(entry + 3 * std::size_t(from), 3, entry + 3 * std::size_t(to));
    }
}

}  // namespace souple
