// SPDX-License-Identifier: MIT
#include "runtime/contact/padded_columns.hpp"

#include <cstdint>
#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#endif

namespace souple {

std::size_t aligned_offset(const std::vector<float>& storage) {
  const auto misfit = reinterpret_cast<std::uintptr_t>(storage.data()) % 64;
  return misfit == 0 ? 0 : (64 - misfit) / sizeof(float);
}

void PaddedColumns::reset(std::size_t height, std::size_t width) {
  height_ = height;
  width_ = width;
  stride_ = (height + pack - 1) / pack * pack;
  storage_.assign(stride_ * width + pack - 1, 0.0F);
  offset_ = aligned_offset(storage_);
}

Mat3 PaddedColumns::block(std::size_t i, std::size_t j) const {
  Mat3 block;
  for (std::size_t c = 0; c < 3; ++c)
    block.col(Eigen::Index(c)) =
        Eigen::Map<const Eigen::Vector3f>(column(3 * j + c) + 3 * i).cast<double>();
  return block;
}

void PaddedColumns::add_to_block(std::size_t i, std::size_t j, const Mat3& block) {
  for (std::size_t c = 0; c < 3; ++c)
    Eigen::Map<Eigen::Vector3f>(column(3 * j + c) + 3 * i) += block.col(Eigen::Index(c)).cast<float>();
}

#if defined(__AVX2__) && defined(__FMA__)
void PaddedColumns::add_product(std::size_t j, const Vec3& change, float* y) const {
  const float *a = column(3 * j), *b = a + stride_, *c = b + stride_;
  const __m256 x = _mm256_set1_ps(float(change[0])), t = _mm256_set1_ps(float(change[1])),
               s = _mm256_set1_ps(float(change[2]));
  for (std::size_t k = 0; k < stride_; k += pack) {
    __m256 low = _mm256_load_ps(y + k), high = _mm256_load_ps(y + k + 8);
    low = _mm256_fmadd_ps(x, _mm256_load_ps(a + k), low);
    high = _mm256_fmadd_ps(x, _mm256_load_ps(a + k + 8), high);
    low = _mm256_fmadd_ps(t, _mm256_load_ps(b + k), low);
    high = _mm256_fmadd_ps(t, _mm256_load_ps(b + k + 8), high);
    _mm256_store_ps(y + k, _mm256_fmadd_ps(s, _mm256_load_ps(c + k), low));
    _mm256_store_ps(y + k + 8, _mm256_fmadd_ps(s, _mm256_load_ps(c + k + 8), high));
  }
}

void PaddedColumns::add_product(std::size_t j, const Vec3& change, double* y) const {
  const float *a = column(3 * j), *b = a + stride_, *c = b + stride_;
  const __m256d x = _mm256_set1_pd(change[0]), t = _mm256_set1_pd(change[1]),
                s = _mm256_set1_pd(change[2]);
  for (std::size_t k = 0; k < stride_; k += 4) {
    __m256d sum = _mm256_loadu_pd(y + k);
    sum = _mm256_fmadd_pd(x, _mm256_cvtps_pd(_mm_load_ps(a + k)), sum);
    sum = _mm256_fmadd_pd(t, _mm256_cvtps_pd(_mm_load_ps(b + k)), sum);
    _mm256_storeu_pd(y + k, _mm256_fmadd_pd(s, _mm256_cvtps_pd(_mm_load_ps(c + k)), sum));
  }
}
#else
namespace {
template <class Scalar>
void add_columns(const float* a, std::size_t stride, const Vec3& change, Scalar* y) {
  const Scalar x = Scalar(change[0]), t = Scalar(change[1]), s = Scalar(change[2]);
  const float *b = a + stride, *c = b + stride;
  for (std::size_t k = 0; k < stride; ++k)
    y[k] += x * Scalar(a[k]) + t * Scalar(b[k]) + s * Scalar(c[k]);
}
}  // namespace

void PaddedColumns::add_product(std::size_t j, const Vec3& change, float* y) const {
  add_columns(column(3 * j), stride_, change, y);
}

void PaddedColumns::add_product(std::size_t j, const Vec3& change, double* y) const {
  add_columns(column(3 * j), stride_, change, y);
}
#endif

}  // namespace souple
