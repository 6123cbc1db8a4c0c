// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/tile_encoder.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {
namespace {

template <class Scalar>
using RowMajor = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Inverse Cholesky factors of the diagonal blocks: ||L^-1 E L^-T|| equals ||D^-1/2 E D^-1/2||.
std::vector<Mat3> inverse_scales(const SymmetricSource& source) {
  std::vector<Mat3> scales;
  Eigen::MatrixXd diagonal(3, 3);
  for (Index node = 0; node < source.node_count(); ++node) {
    source.read({&node, 1}, {&node, 1}, diagonal);
    scales.push_back(Mat3(diagonal).llt().matrixL().solve(Mat3::Identity()));
  }
  return scales;
}

/// Errors of rounding, summed over the tiles of the lower triangle.
class ErrorSums {
 public:
  explicit ErrorSums(const SymmetricSource& source)
      : scales_(inverse_scales(source)),
        column_error_(scales_.size(), Vec3::Zero()),
        column_norm_(column_error_) {}

  /// `rows` x `columns`, both from their first nodes on; of a diagonal tile the lower triangle counts.
  void add(const Eigen::MatrixXd& exact, const Eigen::MatrixXd& difference, Index first_row,
           Index first_column) {
    for (Index b = 0; b < Index(exact.cols() / 3); ++b)
      for (Index a = 0; a < Index(exact.rows() / 3); ++a)
        if (first_row + a >= first_column + b)
          add_pair(exact.block<3, 3>(3 * a, 3 * b), difference.block<3, 3>(3 * a, 3 * b),
                   std::size_t(first_row + a), std::size_t(first_column + b));
  }

  void result(ComplianceError& error) const {
    double error2 = 0, norm2 = 0;
    for (std::size_t node = 0; node < column_error_.size(); ++node) {
      error2 += column_error_[node].sum();
      norm2 += column_norm_[node].sum();
      error.worst_column =
          std::max(error.worst_column,
                   std::sqrt((column_error_[node].array() / column_norm_[node].array()).maxCoeff()));
    }
    error.frobenius = std::sqrt(error2 / norm2);
    error.scaled_spectral = std::sqrt(scaled2_);
  }

 private:
  void add_pair(const Mat3& exact, const Mat3& difference, std::size_t row, std::size_t col) {
    column_error_[col] += difference.colwise().squaredNorm().transpose();
    column_norm_[col] += exact.colwise().squaredNorm().transpose();
    if (row != col) {
      column_error_[row] += difference.rowwise().squaredNorm();
      column_norm_[row] += exact.rowwise().squaredNorm();
    }
    const double scaled = (scales_[row] * difference * scales_[col].transpose()).squaredNorm();
    scaled2_ += row == col ? scaled : 2 * scaled;
  }

  std::vector<Mat3> scales_;
  std::vector<Vec3> column_error_, column_norm_;
  double scaled2_ = 0;
};

template <class Scalar>
std::vector<std::byte> encode_as(const SymmetricSource& source, const TileLayout& layout,
                                 ErrorSums* sums) {
  std::vector<std::byte> payload(std::size_t(layout.block_count() * layout.block_scalars()) *
                                 sizeof(Scalar));
  auto* stored = reinterpret_cast<Scalar*>(payload.data());
  std::vector<Index> nodes(std::size_t(layout.node_count));
  std::iota(nodes.begin(), nodes.end(), 0);
  const auto tile_nodes = std::size_t(layout.tile_nodes);
  const auto nodes_of = [&](std::int64_t tile) {
    const std::size_t first = std::size_t(tile) * tile_nodes;
    return std::span(std::as_const(nodes)).subspan(first, std::min(tile_nodes, nodes.size() - first));
  };
  for (std::int64_t i = 0; i < layout.tile_count(); ++i)
    for (std::int64_t j = 0; j <= i; ++j) {
      const auto rows = nodes_of(i), columns = nodes_of(j);
      Eigen::MatrixXd exact(3 * rows.size(), 3 * columns.size());
      source.read(rows, columns, exact);
      Eigen::Map<RowMajor<Scalar>, 0, Eigen::OuterStride<>> tile(
          stored + TileLayout::block_index(i, j) * layout.block_scalars(), exact.rows(), exact.cols(),
          Eigen::OuterStride<>(3 * Eigen::Index(layout.tile_nodes)));
      tile = exact.cast<Scalar>();
      if (sums) sums->add(exact, exact - tile.template cast<double>(), rows[0], columns[0]);
    }
  return payload;
}

}  // namespace

std::vector<std::byte> encode_tiles(const SymmetricSource& source, const TileLayout& layout,
                                    ScalarType scalar, ComplianceError& error) {
  if (scalar == ScalarType::float64) return encode_as<double>(source, layout, nullptr);
  ErrorSums sums(source);
  auto payload = encode_as<float>(source, layout, &sums);
  sums.result(error);
  return payload;
}

}  // namespace souple
