// SPDX-License-Identifier: MIT
#include "runtime/compliance/decoded_records.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/compliance/product_kernel.hpp"
#include "runtime/compliance/range_decoder.hpp"

namespace souple {
namespace {

std::size_t padded(int rows) { return (std::size_t(rows) + lane_count - 1) / lane_count * lane_count; }

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
  begin_.push_back(0);
  std::size_t most_diagonal = 0, most_factors = 0, most_rows = 0;
  for (const RecordShape& shape : shapes_) {
    const ClusterRange range = range_of(shape.leaf);
    std::fill(leaf_of_position_.begin() + range.begin, leaf_of_position_.begin() + range.end,
              shape.leaf);
    std::size_t terms = 0;
    for (const FactorShape& factor : shape.factors) terms += std::size_t(factor.rank);
    const auto rows = std::size_t(shape.rows);
    begin_.push_back(begin_.back() + padded(shape.rows) * (rows + terms));
    most_diagonal = std::max(most_diagonal, rows * (rows + 1) / 2);
    most_factors = std::max(most_factors, rows * terms);
    most_rows = std::max(most_rows, rows);
  }
  std::size_t term = 0;
  for (const Index rank : index_.rank) {
    first_term_.push_back(term);
    term += std::size_t(rank);
  }
  integers_.diagonal.resize(most_diagonal);
  integers_.factors.resize(most_factors);
  scratch_.reserve(most_rows);
  values_ = std::make_unique_for_overwrite<float[]>(begin_.back());
}

std::size_t DecodedRecords::padded_rows(Index leaf) const {
  return padded(shapes_[std::size_t(leaf)].rows);
}

const float* DecodedRecords::factor(Index leaf, int d) const {
  const RecordShape& shape = shapes_[std::size_t(leaf)];
  std::size_t before = std::size_t(shape.rows);
  for (int above = 0; above < d; ++above) before += std::size_t(shape.factors[std::size_t(above)].rank);
  return diagonal(leaf) + before * padded(shape.rows);
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

Mat3 DecodedRecords::scale_at(Index position) const {
  const auto& l = index_.scale[std::size_t(row_at(position))];
  Mat3 m;
  m << double(l[0]), 0, 0, double(l[1]), double(l[2]), 0, double(l[3]), double(l[4]), double(l[5]);
  return m;
}

void DecodedRecords::store_diagonal(const RecordShape& shape) const {
  const Index first = range_of(shape.leaf).begin, nodes = shape.rows / 3;
  const std::size_t stride = padded(shape.rows);
  const double step = double(index_.leaf_step[std::size_t(shape.leaf)]);
  float* out = values_.get() + begin_[std::size_t(shape.leaf)];
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
      block = (scale_at(first + a) * block * scale_at(first + b).transpose()).eval();
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
  float* out = values_.get() + begin_[std::size_t(shape.leaf)] + stride * rows;
  const std::int32_t* value = integers_.factors.data();
  const Index first = range_of(shape.leaf).begin;
  for (std::size_t d = 0; d < shape.factors.size(); ++d) {
    const FactorShape& factor = shape.factors[d];
    std::size_t active = 0;
    for (std::size_t k = 0; k < std::size_t(factor.rank); ++k, value += rows, out += stride) {
      const double unit =
          double(index_.step[factor.block]) / std::sqrt(double(index_.singular[factor.first_term + k]));
      for (std::size_t a = 0; a < rows / 3; ++a) {
        const Vec3 integer(value[3 * a], value[3 * a + 1], value[3 * a + 2]);
        if ((integer.array() != 0).any()) active = k + 1;
        Eigen::Map<Eigen::Vector3f>(out + 3 * a) =
            (unit * (scale_at(first + Index(a)) * integer)).cast<float>();
      }
      std::fill(out + rows, out + stride, 0.0F);
    }
    active_[std::size_t(shape.leaf) * std::size_t(depth_) + d] = std::uint32_t(active);
  }
}

std::size_t DecodedRecords::resident_bytes() const {
  std::size_t floats = 0;
  for (Index leaf = 0; leaf < leaf_count(); ++leaf)
    if (is_ready(leaf)) floats += begin_[std::size_t(leaf) + 1] - begin_[std::size_t(leaf)];
  return source_->resident_bytes() + floats * sizeof(float) +
         (2 * position_of_row_.size() + index_.order.size()) * sizeof(Index) +
         index_.scale.size() * sizeof(index_.scale[0]) +
         (integers_.diagonal.size() + integers_.factors.size()) * sizeof(std::int32_t);
}

}  // namespace souple
