// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/block_sampler.hpp"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

// Samples that are orthogonalised, and asked for what is still missing, at once.
constexpr Eigen::Index probe_columns = 32;
constexpr double noise_margin = 2;
constexpr Eigen::Index combined_rows = 4096;  // of one piece of a product

// SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

}  // namespace

void fill_signs(std::uint64_t level, std::uint64_t column, std::int64_t first_row,
                Eigen::Ref<Eigen::MatrixXf> out) {
  for (Eigen::Index c = 0; c < out.cols(); ++c) {
    const std::uint64_t key = mixed(mixed(level) ^ (column + std::uint64_t(c)));
    std::uint64_t bits = 0, word = ~std::uint64_t{0};
    for (Eigen::Index r = 0; r < out.rows(); ++r) {
      const auto row = std::uint64_t(first_row + r);
      if (row / 64 != word) bits = mixed(key ^ (word = row / 64));
      out(r, c) = (bits >> (row % 64)) & 1 ? 1.0F : -1.0F;
    }
  }
}

// Twice: once leaves what rounding put back.
void BlockSampler::project_out(FloatRef samples) const {
  Eigen::MatrixXf coefficients;
  for (int pass = 0; pass < 2; ++pass)
    for (const Eigen::MatrixXf& part : parts_) {
      coefficients.setZero(part.cols(), samples.cols());
      add_transposed_product(1, part, samples, coefficients);
      add_product(-1, part, coefficients, samples);
    }
}

void BlockSampler::take(Eigen::Index begin, const ConstFloatRef& part) {
  FloatRef place = samples_.middleCols(begin, part.cols());
  place = part;
  project_out(place);
}

// Random signs have E ||R w||^2 = ||R||_F^2; the largest singular value of |w| samples over the root of
// their number is at least about that of R, and more where many singular values are alike.
double BlockSampler::remainder_of(const ConstFloatRef& samples) const {
  const double norm = bounds_.frobenius ? double(samples.norm()) : spectral_norm(samples);
  return norm / std::sqrt(double(samples.cols()));
}

// Fresh samples find at least their own rounding errors: those of a random matrix.
double BlockSampler::sampling_goal(Eigen::Index count) const {
  const double rows = std::sqrt(double(rows_)), columns = std::sqrt(double(count));
  const double floor = bounds_.frobenius ? rows : (rows + columns) / columns;
  return std::max(bounds_.sampled, noise_margin * bounds_.noise * floor);
}

void BlockSampler::end_round() {
  const std::size_t earlier = parts_.size();
  const Eigen::Index full = std::min(rows_, columns_);
  Eigen::MatrixXf r;
  for (Eigen::Index begin = 0; begin < samples_.cols() && !complete_; begin += probe_columns) {
    Eigen::MatrixXf probe =
        samples_.middleCols(begin, std::min(probe_columns, samples_.cols() - begin));
    if (parts_.size() > earlier) project_out(probe);
    complete_ = remainder_of(probe) <= sampling_goal(probe.cols()) || rank_ == full;
    if (complete_) break;
    probe.conservativeResize(Eigen::NoChange, std::min(probe.cols(), full - rank_));
    complete_ = !orthonormalise(probe, r);
    // What the samples lost to cancellation comes back enlarged: once more against the basis.
    project_out(probe);
    complete_ = complete_ || !orthonormalise(probe, r);
    rank_ += probe.cols();
    parts_.push_back(std::move(probe));
  }
  samples_.resize(0, 0);
}

bool BlockSampler::join_basis(const PieceRunner& run) {
  basis_.resize(rows_, rank_);
  Eigen::Index at = 0;
  for (Eigen::MatrixXf& part : parts_) {
    basis_.middleCols(at, part.cols()) = part;
    at += part.cols();
    part.resize(0, 0);
  }
  parts_.clear();
  image_.resize(columns_, rank_);
  // Singular values reach a million times the bound: what single precision calls orthonormal is not
  // enough for the first ones.
  Eigen::MatrixXd r;
  return orthonormalise_in_double(basis_, r, run);
}

Eigen::Index BlockSampler::kept(const Eigen::VectorXd& singular) const {
  Eigen::Index count = singular.size();
  double dropped = 0;
  for (; count > 0; --count) {
    const double value = singular[count - 1];
    dropped = bounds_.frobenius ? std::hypot(dropped, value) : value;
    if (dropped > bounds_.truncated) break;
  }
  return count;
}

bool BlockSampler::finish(LowRankBlock& out, const PieceRunner& run) {
  // block = Q Z^T with Z = P R: the small factor is R^T.
  Eigen::MatrixXd r;
  if (!orthonormalise_in_double(image_, r, run)) return false;
  const SmallSvd svd = singular_values(r.transpose());
  if (!svd.converged) return false;
  const Eigen::Index count = kept(svd.singular);
  out.singular = svd.singular.head(count).cast<float>();
  const auto combined = [&](const Eigen::MatrixXf& columns, const Eigen::MatrixXd& small,
                            Eigen::MatrixXf& result) {
    const Eigen::MatrixXf factors = small.leftCols(count).cast<float>();
    result.setZero(columns.rows(), count);
    run(std::size_t((columns.rows() + combined_rows - 1) / combined_rows), [&](std::size_t piece) {
      const Eigen::Index row = Eigen::Index(piece) * combined_rows;
      const Eigen::Index height = std::min(combined_rows, columns.rows() - row);
      add_product(1, columns.middleRows(row, height), factors, result.middleRows(row, height));
    });
  };
  combined(basis_, svd.left, out.left);
  combined(image_, svd.right, out.right);
  return true;
}

}  // namespace souple
