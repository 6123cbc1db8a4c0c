// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/tile_encoder.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Visits every stored 3x3 block (row, col), col <= row, of the tiles; `at` is its first scalar.
template <class Visitor>
void for_each_node_pair(const TileLayout& layout, Visitor visit) {
  const std::int64_t t = layout.tile_nodes;
  for (std::int64_t row = 0; row < layout.node_count; ++row)
    for (std::int64_t col = 0; col <= row; ++col) {
      const std::int64_t block = TileLayout::block_index(row / t, col / t);
      visit(row, col, block * layout.block_scalars() + 9 * (row % t) * t + 3 * (col % t));
    }
}

Mat3 load_block(const double* first, std::int64_t stride) {
  Mat3 block;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) block(i, j) = first[i * stride + j];
  return block;
}

// Inverse Cholesky factors of the diagonal blocks: ||L^-1 E L^-T|| equals ||D^-1/2 E D^-1/2||.
std::vector<Mat3> inverse_scales(const std::vector<double>& tiles, const TileLayout& layout) {
  std::vector<Mat3> scales(std::size_t(layout.node_count));
  for_each_node_pair(layout, [&](std::int64_t row, std::int64_t col, std::int64_t at) {
    if (row != col) return;
    const Mat3 diagonal = load_block(tiles.data() + at, 3 * layout.tile_nodes);
    scales[std::size_t(row)] = diagonal.llt().matrixL().solve(Mat3::Identity());
  });
  return scales;
}

void measure_error(const std::vector<double>& tiles, const float* stored, const TileLayout& layout,
                   ComplianceError& error) {
  const auto scales = inverse_scales(tiles, layout);
  const std::int64_t stride = 3 * std::int64_t{layout.tile_nodes};
  std::vector<Vec3> column_error(std::size_t(layout.node_count), Vec3::Zero());
  std::vector<Vec3> column_norm = column_error;
  double scaled2 = 0;
  for_each_node_pair(layout, [&](std::int64_t row, std::int64_t col, std::int64_t at) {
    const Mat3 exact = load_block(tiles.data() + at, stride);
    Mat3 difference;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) difference(i, j) = exact(i, j) - double(stored[at + i * stride + j]);
    column_error[std::size_t(col)] += difference.colwise().squaredNorm().transpose();
    column_norm[std::size_t(col)] += exact.colwise().squaredNorm().transpose();
    if (row != col) {
      column_error[std::size_t(row)] += difference.rowwise().squaredNorm();
      column_norm[std::size_t(row)] += exact.rowwise().squaredNorm();
    }
    const double scaled =
        (scales[std::size_t(row)] * difference * scales[std::size_t(col)].transpose()).squaredNorm();
    scaled2 += row == col ? scaled : 2 * scaled;
  });
  double error2 = 0, norm2 = 0;
  for (std::size_t node = 0; node < column_error.size(); ++node) {
    error2 += column_error[node].sum();
    norm2 += column_norm[node].sum();
    error.worst_column =
        std::max(error.worst_column,
                 std::sqrt((column_error[node].array() / column_norm[node].array()).maxCoeff()));
  }
  error.frobenius = std::sqrt(error2 / norm2);
  error.scaled_spectral = std::sqrt(scaled2);
}

}  // namespace

std::vector<std::byte> encode_tiles(const std::vector<double>& tiles, const TileLayout& layout,
                                    ScalarType scalar, ComplianceError& error) {
  if (scalar == ScalarType::float64) {
    std::vector<std::byte> payload(tiles.size() * sizeof(double));
    std::memcpy(payload.data(), tiles.data(), payload.size());
    return payload;
  }
  std::vector<std::byte> payload(tiles.size() * sizeof(float));
  auto* stored = reinterpret_cast<float*>(payload.data());
  std::ranges::transform(tiles, stored, [](double value) { return static_cast<float>(value); });
  measure_error(tiles, stored, layout, error);
  return payload;
}

}  // namespace souple
