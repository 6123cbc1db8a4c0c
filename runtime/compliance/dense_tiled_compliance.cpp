// SPDX-License-Identifier: MIT
#include "runtime/compliance/dense_tiled_compliance.hpp"

#include <algorithm>

namespace souple {

template <class Scalar>
DenseTiledCompliance<Scalar>::DenseTiledCompliance(TileLayout layout,
                                                   std::unique_ptr<BlockSource> source)
    : layout_(layout), source_(std::move(source)) {}

// Payloads come from vectors and are whole blocks of scalars, so the alignment holds.
template <class Scalar>
const Scalar* DenseTiledCompliance<Scalar>::tile(std::int64_t i, std::int64_t j) const {
  return reinterpret_cast<const Scalar*>(source_->block(TileLayout::block_index(i, j)).data());
}

template <class Scalar>
bool DenseTiledCompliance<Scalar>::ready(std::span<const Index> rows) const {
  const std::int64_t tiles = layout_.tile_count();
  bool all = true;
  for (const Index row : rows) {
    const std::int64_t t = row / layout_.tile_nodes;
    for (std::int64_t other = 0; other < tiles; ++other) {
      const auto block = std::size_t(TileLayout::block_index(std::max(t, other), std::min(t, other)));
      if (source_->ready(block)) continue;
      source_->request(block);
      all = false;
    }
  }
  return all;
}

// Only the lower triangle is stored: above it, the transpose.
template <class Scalar>
Mat3 DenseTiledCompliance<Scalar>::node_block(Index row, Index column) const {
  using Block = Eigen::Matrix<Scalar, 3, 3, Eigen::RowMajor>;
  const Index t = layout_.tile_nodes;
  const Index low = std::max(row, column), high = std::min(row, column);
  const Eigen::Index stride = 3 * Eigen::Index(t);
  const Eigen::Map<const Block, 0, Eigen::OuterStride<>> block(
      tile(low / t, high / t) + 3 * (low % t) * stride + 3 * (high % t), Eigen::OuterStride<>(stride));
  return row < column ? Mat3(block.transpose().template cast<double>())
                      : Mat3(block.template cast<double>());
}

template <class Scalar>
void DenseTiledCompliance<Scalar>::gather(std::span<const Index> rows, std::span<double> out) const {
  const std::size_t leading = 3 * rows.size();
  for (std::size_t a = 0; a < rows.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      const Mat3 block = node_block(rows[a], rows[b]);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          out[(3 * a + i) * leading + 3 * b + j] = out[(3 * b + j) * leading + 3 * a + i] =
              block(Eigen::Index(i), Eigen::Index(j));
    }
}

template <class Scalar>
void DenseTiledCompliance<Scalar>::gather_block(std::span<const Index> rows,
                                                std::span<const Index> columns, float* out,
                                                std::size_t stride, ComplianceWork&) const {
  for (std::size_t a = 0; a < rows.size(); ++a)
    for (std::size_t b = 0; b < columns.size(); ++b) {
      const Mat3 block = node_block(rows[a], columns[b]);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          out[(3 * a + i) * stride + 3 * b + j] = float(block(Eigen::Index(i), Eigen::Index(j)));
    }
}

namespace {

// sum += three rows of a tile, weighted by f: contiguous, so that it vectorises.
template <class Scalar>
void add_rows(const Scalar* rows, std::size_t stride, const double* f, std::size_t count, double* sum) {
  for (std::size_t k = 0; k < count; ++k)
    sum[k] += f[0] * rows[k] + f[1] * rows[stride + k] + f[2] * rows[2 * stride + k];
}

// sum += three columns of a tile, weighted by f.
template <class Scalar>
void add_columns(const Scalar* columns, std::size_t stride, const double* f, std::size_t count,
                 double* sum) {
  for (std::size_t k = 0; k < count; ++k) {
    const Scalar* c = columns + k * stride;
    sum[k] += f[0] * c[0] + f[1] * c[1] + f[2] * c[2];
  }
}

}  // namespace

template <class Scalar>
void DenseTiledCompliance<Scalar>::apply(std::span<const Index> rows, std::span<const double> force,
                                         std::span<double> displacement, ComplianceWork&) const {
  std::ranges::fill(displacement, 0.0);
  const std::int64_t tile_nodes = layout_.tile_nodes;
  const std::size_t stride = 3 * std::size_t(tile_nodes);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double* f = force.data() + 3 * r;
    const std::int64_t own_tile = rows[r] / tile_nodes;
    const std::size_t within = 3 * std::size_t(rows[r] % tile_nodes);
    for (std::int64_t t = 0; t < layout_.tile_count(); ++t) {
      const std::size_t first = stride * std::size_t(t);
      const std::size_t count = std::min(stride, displacement.size() - first);
      if (t <= own_tile)
        add_rows(tile(own_tile, t) + within * stride, stride, f, count, displacement.data() + first);
      else
        add_columns(tile(t, own_tile) + within, stride, f, count, displacement.data() + first);
    }
  }
}

template class DenseTiledCompliance<float>;
template class DenseTiledCompliance<double>;

}  // namespace souple
