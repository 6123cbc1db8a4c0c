// SPDX-License-Identifier: MIT
#include "runtime/contact/delassus_operator.hpp"

#include <algorithm>
#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#endif

namespace souple {
namespace {

// The touches of one contact: [first, last).
std::size_t group_end(std::span<const Touch> touches, std::size_t first) {
  std::size_t last = first + 1;
  while (last < touches.size() && touches[last].contact == touches[first].contact) ++last;
  return last;
}

// G = weight F^T R of every touch, transposed and padded: entry (i, j) at 12 t + 4 j + i.
template <class Scalar>
void contact_jacobians(const ContactGeometry& body, std::vector<Scalar>& jacobian) {
  jacobian.assign(12 * body.touches.size(), Scalar(0));
  for (std::size_t t = 0; t < body.touches.size(); ++t) {
    const Touch& touch = body.touches[t];
    const Mat3 g = touch.weight * (body.frames[std::size_t(touch.contact)].transpose() *
                                   body.rotations[std::size_t(touch.node)]);
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) jacobian[12 * t + std::size_t(4 * j + i)] = Scalar(g(i, j));
  }
}

#if defined(__AVX2__) && defined(__FMA__)
constexpr std::size_t lanes = 8;

// The first columns of add_rows in eights; returns how many.
std::size_t add_rows_wide(const float* g, const float* source, std::size_t stride, std::size_t size,
                          float* rows, std::size_t width) {
  __m256 factor[9];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) factor[3 * i + j] = _mm256_set1_ps(g[4 * j + i]);
  std::size_t k = 0;
  for (; k + lanes <= size; k += lanes) {
    const __m256 s0 = _mm256_loadu_ps(source + k), s1 = _mm256_loadu_ps(source + stride + k),
                 s2 = _mm256_loadu_ps(source + 2 * stride + k);
    for (std::size_t i = 0; i < 3; ++i) {
      __m256 sum = _mm256_loadu_ps(rows + i * width + k);
      sum = _mm256_fmadd_ps(factor[3 * i], s0, sum);
      sum = _mm256_fmadd_ps(factor[3 * i + 1], s1, sum);
      sum = _mm256_fmadd_ps(factor[3 * i + 2], s2, sum);
      _mm256_storeu_ps(rows + i * width + k, sum);
    }
  }
  return k;
}
#else
std::size_t add_rows_wide(const float*, const float*, std::size_t, std::size_t, float*, std::size_t) {
  return 0;
}
#endif
std::size_t add_rows_wide(const double*, const double*, std::size_t, std::size_t, double*,
                          std::size_t) {
  return 0;
}

// rows (3 x width) += g times three rows of C0, `size` of each.
template <class Scalar>
void add_rows(const Scalar* g, const Scalar* source, std::size_t stride, std::size_t size, Scalar* rows,
              std::size_t width) {
  for (std::size_t k = add_rows_wide(g, source, stride, size, rows, width); k < size; ++k) {
    const Scalar s0 = source[k], s1 = source[stride + k], s2 = source[2 * stride + k];
    for (std::size_t i = 0; i < 3; ++i)
      rows[i * width + k] += g[i] * s0 + g[4 + i] * s1 + g[8 + i] * s2;
  }
}

// rows (3 x 3 of width) += half of g times a diagonal block.
template <class Scalar>
void add_half_block(const Scalar* g, const Scalar* source, std::size_t stride, Scalar* rows,
                    std::size_t width) {
  Scalar half[12];
  for (std::size_t k = 0; k < 12; ++k) half[k] = Scalar(0.5) * g[k];
  add_rows(half, source, stride, 3, rows, width);
}

// sum (3 x 4, the last column padding) = the sum of rows(:, three columns of a node) g^T over touches
// [first, last) whose columns are there.
template <class Scalar>
void sum_blocks(const DelassusWork<Scalar>& work, std::size_t width, std::size_t first,
                std::size_t last, Scalar (&sum)[12]) {
  std::fill_n(sum, 12, Scalar(0));
  for (std::size_t t = first; t < last; ++t) {
    if (work.slot[t] >= width) continue;
    const Scalar* g = &work.jacobian[12 * t];
    for (std::size_t i = 0; i < 3; ++i) {
      const Scalar *r = work.rows.data() + i * width + work.slot[t], a = r[0], b = r[1], c = r[2];
      for (std::size_t q = 0; q < 4; ++q) sum[4 * i + q] += a * g[q] + b * g[4 + q] + c * g[8 + q];
    }
  }
}

#if defined(__AVX2__) && defined(__FMA__)
void sum_blocks(const DelassusWork<float>& work, std::size_t width, std::size_t first, std::size_t last,
                float (&sum)[12]) {
  __m128 row[3] = {_mm_setzero_ps(), _mm_setzero_ps(), _mm_setzero_ps()};
  for (std::size_t t = first; t < last; ++t) {
    if (work.slot[t] >= width) continue;
    const float *g = &work.jacobian[12 * t], *r = work.rows.data() + work.slot[t];
    const __m128 g0 = _mm_loadu_ps(g), g1 = _mm_loadu_ps(g + 4), g2 = _mm_loadu_ps(g + 8);
    for (std::size_t i = 0; i < 3; ++i, r += width) {
      row[i] = _mm_fmadd_ps(_mm_broadcast_ss(r), g0, row[i]);
      row[i] = _mm_fmadd_ps(_mm_broadcast_ss(r + 1), g1, row[i]);
      row[i] = _mm_fmadd_ps(_mm_broadcast_ss(r + 2), g2, row[i]);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) _mm_storeu_ps(sum + 4 * i, row[i]);
}
#endif

template <class Target>
void add_scaled_block(const auto& block, double factor, Target* target, std::size_t stride) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      target[i * stride + j] += Target(factor * double(block[4 * i + j]));
}

template <class Target>
void add_scaled_transpose(const auto& block, double factor, Target* target, std::size_t stride) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      target[j * stride + i] += Target(factor * double(block[4 * i + j]));
}

// Slots and groups of the touches.
template <class Scalar>
void index_touches(std::span<const Touch> touches, std::span<const Index> slot,
                   DelassusWork<Scalar>& work) {
  work.slot.clear();
  for (const Touch& touch : touches)
    work.slot.push_back(3 * std::size_t(slot[std::size_t(touch.node)]));
  work.group.clear();
  for (std::size_t t = 0; t < touches.size(); t = group_end(touches, t)) work.group.push_back(t);
  work.group.push_back(touches.size());
}

// work.rows (3 x width) = the rows of G L of touches [first, last); returns the width: no column beyond
// has anything.
template <class Scalar>
std::size_t multiply_lower(const NodeCompliance<Scalar>& compliance, std::size_t first,
                           std::size_t last, DelassusWork<Scalar>& work) {
  std::size_t width = 0;
  for (std::size_t t = first; t < last; ++t) width = std::max(width, work.slot[t] + 3);
  std::fill_n(work.rows.begin(), 3 * width, Scalar(0));
  for (std::size_t t = first; t < last; ++t) {
    const Scalar *g = &work.jacobian[12 * t],
                 *row = compliance.values + work.slot[t] * compliance.stride;
    add_rows(g, row, compliance.stride, work.slot[t], work.rows.data(), width);
    add_half_block(g, row + work.slot[t], compliance.stride, work.rows.data() + work.slot[t], width);
  }
  return width;
}

}  // namespace

template <class Scalar, class Target>
void add_to_delassus(const ContactGeometry& body, const NodeCompliance<Scalar>& compliance,
                     double factor, const DelassusTarget<Target>& delassus,
                     DelassusWork<Scalar>& work) {
  const std::span<const Touch> touches = body.touches;
  const std::size_t stride = delassus.stride;
  contact_jacobians(body, work.jacobian);
  index_touches(touches, compliance.slot, work);
  work.rows.resize(9 * compliance.slot.size());
  const std::size_t groups = work.group.size() - 1;
  for (std::size_t i = 0; i < groups; ++i) {
    const std::size_t width = multiply_lower(compliance, work.group[i], work.group[i + 1], work);
    const auto contact = 3 * std::size_t(touches[work.group[i]].contact);
    for (std::size_t j = 0; j < groups; ++j) {
      Scalar sum[12];
      sum_blocks(work, width, work.group[j], work.group[j + 1], sum);
      const auto other = 3 * std::size_t(touches[work.group[j]].contact);
      if (other <= contact)
        add_scaled_block(sum, factor, delassus.values + contact * stride + other, stride);
      if (other >= contact)
        add_scaled_transpose(sum, factor, delassus.values + other * stride + contact, stride);
    }
  }
}

template void add_to_delassus(const ContactGeometry&, const NodeCompliance<float>&, double,
                              const DelassusTarget<float>&, DelassusWork<float>&);
template void add_to_delassus(const ContactGeometry&, const NodeCompliance<float>&, double,
                              const DelassusTarget<double>&, DelassusWork<float>&);
template void add_to_delassus(const ContactGeometry&, const NodeCompliance<double>&, double,
                              const DelassusTarget<float>&, DelassusWork<double>&);
template void add_to_delassus(const ContactGeometry&, const NodeCompliance<double>&, double,
                              const DelassusTarget<double>&, DelassusWork<double>&);

// C_rigid between a and b is [I, A] diag(1/m, J^-1) [I, B]^T with A the cross product with a - centre.
template <class Target>
void add_rigid_to_delassus(const ContactGeometry& body, const RigidModes& modes,
                           std::span<const Vec3> points, double factor,
                           const DelassusTarget<Target>& delassus, DelassusWork<double>& work) {
  using Rows = Eigen::Map<Eigen::Matrix<double, 3, 6, Eigen::RowMajor>>;
  const std::size_t stride = delassus.stride;
  contact_jacobians(body, work.jacobian);
  work.rows.assign(18 * body.frames.size(), 0.0);
  const auto motions = [&](Index contact) -> Rows {
    return Rows(&work.rows[18 * std::size_t(contact)]);
  };
  for (std::size_t t = 0; t < body.touches.size(); ++t) {
    const Eigen::Map<const Mat3, 0, Eigen::OuterStride<4>> g(&work.jacobian[12 * t]);
    Rows rows = motions(body.touches[t].contact);
    rows.leftCols<3>() += g;
    const Vec3 arm = points[std::size_t(body.touches[t].node)] - modes.centre();
    for (int i = 0; i < 3; ++i) rows.block<1, 3>(i, 3) += g.row(i).cross(arm.transpose());
  }
  for (std::size_t i = 0, i_end; i < body.touches.size(); i = i_end) {
    i_end = group_end(body.touches, i);
    const Rows left = motions(body.touches[i].contact);
    Target* row = delassus.values + 3 * std::size_t(body.touches[i].contact) * stride;
    for (std::size_t j = 0, j_end; j <= i; j = j_end) {
      j_end = group_end(body.touches, j);
      const Rows right = motions(body.touches[j].contact);
      Eigen::Matrix<double, 3, 4, Eigen::RowMajor> block;
      block.leftCols<3>() =
          modes.inverse_mass() * left.leftCols<3>() * right.leftCols<3>().transpose() +
          left.rightCols<3>() * modes.inverse_inertia() * right.rightCols<3>().transpose();
      add_scaled_block(block.reshaped<Eigen::RowMajor>(), factor,
                       row + 3 * std::size_t(body.touches[j].contact), stride);
    }
  }
}

template void add_rigid_to_delassus(const ContactGeometry&, const RigidModes&, std::span<const Vec3>,
                                    double, const DelassusTarget<float>&, DelassusWork<double>&);
template void add_rigid_to_delassus(const ContactGeometry&, const RigidModes&, std::span<const Vec3>,
                                    double, const DelassusTarget<double>&, DelassusWork<double>&);

// By tiles, so that neither side strides through memory.
template <class Target>
void mirror_delassus(std::size_t contact_count, const DelassusTarget<Target>& delassus) {
  constexpr std::size_t tile = 16;
  const std::size_t size = 3 * contact_count;
  const auto& [values, stride] = delassus;
  for (std::size_t row0 = 0; row0 < size; row0 += tile)
    for (std::size_t col0 = 0; col0 <= row0; col0 += tile)
      for (std::size_t row = row0; row < std::min(row0 + tile, size); ++row)
        for (std::size_t col = col0; col < std::min(col0 + tile, row); ++col)
          values[col * stride + row] = values[row * stride + col];
}

template void mirror_delassus(std::size_t, const DelassusTarget<float>&);
template void mirror_delassus(std::size_t, const DelassusTarget<double>&);

}  // namespace souple
