// SPDX-License-Identifier: MIT
#include "runtime/compliance/decoded_records.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/compliance/product_kernel.hpp"
#include "runtime/compliance/range_decoder.hpp"

namespace souple {
namespace {

std::size_t padded(int rows) { return (std::size_t(rows) + product_lane_count - 1) / product_lane_count * product_lane_count; }

// Integers of three bytes are kept as four.
std::size_t bytes_of(std::uint8_t planes) { return planes <= 2 ? planes : 4; }

// `count` rows of one term, padded with zeros; returns the end.
template <class Integer>
std::byte* store_integers(const std::int32_t* values, std::size_t count, std::size_t padded_count,
                          std::byte* out) {
  auto* to = reinterpret_cast<Integer*>(out);
  for (std::size_t k = 0; k < count; ++k) to[k] = static_cast<Integer>(values[k]);
  std::fill(to + count, to + padded_count, Integer(0));
  return out + padded_count * sizeof(Integer);
}

bool fits(std::int32_t value, std::uint8_t planes) {
  const std::int64_t limit = std::int64_t{1} << (8 * planes - 1);
  return value > -limit && value < limit;
}

}  // namespace

DecodedRecords::DecodedRecords(Index node_count, HierarchicalIndex index, double shift,
                               std::unique_ptr<BlockSource> source)
    : node_count_(node_count),
      depth_(int(index.depth)),
      shift_(float(shift)),
      index_(std::move(index)),
      source_(std::move(source)),
      shapes_(record_shapes(index_, node_count)),
      position_of_row_(std::size_t(node_count)),
      leaf_of_position_(std::size_t(node_count)),
      active_(shapes_.size() * std::size_t(depth_)),
      state_(shapes_.size()) {
  for (Index position = 0; position < node_count; ++position)
    position_of_row_[std::size_t(row_at(position))] = position;
  find_runs();
  begin_.push_back(0);
  factor_begin_.push_back(0);
  std::size_t most_diagonal = 0, most_factors = 0, most_rows = 0;
  for (const RecordShape& shape : shapes_) {
    const ClusterRange range = range_of(shape.leaf);
    std::fill(leaf_of_position_.begin() + range.begin, leaf_of_position_.begin() + range.end,
              shape.leaf);
    const auto rows = std::size_t(shape.rows);
    std::size_t terms = 0;
    for (const FactorShape& factor : shape.factors) {
      std::size_t bytes = 0;
      for (std::size_t k = 0; k < std::size_t(factor.rank); ++k)
        bytes += bytes_of(index_.planes[factor.first_term + k]);
      factor_begin_.push_back(factor_begin_.back() + padded(shape.rows) * bytes);
      terms += std::size_t(factor.rank);
    }
    begin_.push_back(begin_.back() + padded(shape.rows) * rows);
    most_diagonal = std::max(most_diagonal, rows * (rows + 1) / 2);
    most_factors = std::max(most_factors, rows * terms);
    most_rows = std::max(most_rows, rows);
  }
  integers_.diagonal.resize(most_diagonal);
  integers_.factors.resize(most_factors);
  scratch_.reserve(most_rows);
  diagonals_ = std::make_unique_for_overwrite<float[]>(begin_.back());
  factors_ = std::make_unique_for_overwrite<std::byte[]>(factor_begin_.back());
}

void DecodedRecords::find_runs() {
  std::size_t term = 0;
  for (std::size_t block = 0; block < index_.rank.size(); ++block) {
    first_term_.push_back(term);
    first_run_.push_back(runs_.size());
    for (std::size_t k = 0; k < std::size_t(index_.rank[block]); ++k, ++term) {
      const std::size_t bytes = bytes_of(index_.planes[term]);
      if (k == 0 || runs_.back().bytes != bytes) runs_.push_back({k, bytes});
      runs_.back().last = k + 1;
      units_.push_back(float(double(index_.step[block]) / std::sqrt(double(index_.singular[term]))));
    }
  }
  first_run_.push_back(runs_.size());
}

std::size_t DecodedRecords::padded_rows(Index leaf) const {
  return padded(shapes_[std::size_t(leaf)].rows);
}

bool DecodedRecords::make_ready(Index leaf) const {
  const std::atomic<State>& state = state_[std::size_t(leaf)];
  State now = state.load(std::memory_order_acquire);
  if (now == State::absent) {
    if (!source_->ready(std::size_t(leaf))) {
      source_->request(std::size_t(leaf));
      return false;
    }
    while (decoding_.test_and_set(std::memory_order_acquire)) {
    }
    if (state.load(std::memory_order_relaxed) == State::absent)
      state_[std::size_t(leaf)].store(decode(leaf) ? State::decoded : State::corrupt,
                                      std::memory_order_release);
    decoding_.clear(std::memory_order_release);
    now = state.load(std::memory_order_acquire);
  }
  return now == State::decoded;
}

bool DecodedRecords::decode(Index leaf) const {
  const RecordShape& shape = shapes_[std::size_t(leaf)];
  if (!read_integers(shape, source_->block(std::size_t(leaf)))) return false;
  store_diagonal(shape);
  store_factors(shape);
  return true;
}

bool DecodedRecords::read_integers(const RecordShape& shape, std::span<const std::byte> record) const {
  RangeDecoder decoder(record);
  RecordModel<RangeDecoder>(decoder, index_, scratch_).code(shape, integers_);
  const auto rows = std::size_t(shape.rows);
  const std::uint8_t planes = index_.leaf_planes[std::size_t(shape.leaf)];
  for (std::size_t k = 0; k < rows * (rows + 1) / 2; ++k)
    if (!fits(integers_.diagonal[k], planes)) return false;
  const std::int32_t* value = integers_.factors.data();
  for (const FactorShape& factor : shape.factors)
    for (std::size_t k = 0; k < std::size_t(factor.rank); ++k, value += rows)
      for (std::size_t i = 0; i < rows; ++i)
        if (!fits(value[i], index_.planes[factor.first_term + k])) return false;
  return true;
}

Mat3 DecodedRecords::scale_matrix(Index position) const {
  const auto& l = scale_at(position);
  Mat3 m;
  m << double(l[0]), 0, 0, double(l[1]), double(l[2]), 0, double(l[3]), double(l[4]), double(l[5]);
  return m;
}

void DecodedRecords::store_diagonal(const RecordShape& shape) const {
  const Index first = range_of(shape.leaf).begin, nodes = shape.rows / 3;
  const std::size_t stride = padded(shape.rows);
  const double step = double(index_.leaf_step[std::size_t(shape.leaf)]);
  float* out = diagonals_.get() + begin_[std::size_t(shape.leaf)];
  std::fill_n(out, stride * std::size_t(shape.rows), 0.0F);
  for (Index a = 0; a < nodes; ++a)
    for (Index b = 0; b <= a; ++b) {
      Mat3 block;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const std::int64_t row = std::max(3 * a + i, 3 * b + j),
                             column = std::min(3 * a + i, 3 * b + j);
          block(i, j) = step * integers_.diagonal[std::size_t(row * (row + 1) / 2 + column)];
        }
      if (a == b) block.diagonal().array() += double(shift_);
      block = (scale_matrix(first + a) * block * scale_matrix(first + b).transpose()).eval();
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          if (a == b && j > i) continue;  // rounding may break the symmetry of the product
          const float value = float(block(i, j));
          out[std::size_t(3 * a + i) * stride + std::size_t(3 * b + j)] = value;
          out[std::size_t(3 * b + j) * stride + std::size_t(3 * a + i)] = value;
        }
    }
}

void DecodedRecords::store_factors(const RecordShape& shape) const {
  const std::size_t stride = padded(shape.rows), rows = std::size_t(shape.rows);
  const std::int32_t* value = integers_.factors.data();
  for (std::size_t d = 0; d < shape.factors.size(); ++d) {
    const FactorShape& terms = shape.factors[d];
    std::byte* out = factor(shape.leaf, int(d));
    std::size_t active = 0;
    for (std::size_t k = 0; k < std::size_t(terms.rank); ++k, value += rows) {
      if (std::any_of(value, value + rows, [](std::int32_t v) { return v != 0; })) active = k + 1;
      const std::size_t bytes = bytes_of(index_.planes[terms.first_term + k]);
      out = bytes == 1   ? store_integers<std::int8_t>(value, rows, stride, out)
            : bytes == 2 ? store_integers<std::int16_t>(value, rows, stride, out)
                         : store_integers<std::int32_t>(value, rows, stride, out);
    }
    active_[std::size_t(shape.leaf) * std::size_t(depth_) + d] = std::uint32_t(active);
  }
}

std::size_t DecodedRecords::resident_bytes() const {
  std::size_t bytes = 0;
  for (Index leaf = 0; leaf < leaf_count(); ++leaf) {
    if (!is_ready(leaf)) continue;
    const std::size_t first = std::size_t(leaf) * std::size_t(depth_);
    bytes += (begin_[std::size_t(leaf) + 1] - begin_[std::size_t(leaf)]) * sizeof(float) +
             factor_begin_[first + std::size_t(depth_)] - factor_begin_[first];
  }
  return source_->resident_bytes() + bytes +
         (2 * position_of_row_.size() + index_.order.size()) * sizeof(Index) +
         index_.scale.size() * sizeof(index_.scale[0]) + units_.size() * sizeof(float) +
         (integers_.diagonal.size() + integers_.factors.size()) * sizeof(std::int32_t);
}

}  // namespace souple
