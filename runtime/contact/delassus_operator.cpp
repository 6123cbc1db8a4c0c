// SPDX-License-Identifier: MIT
#include "runtime/contact/delassus_operator.hpp"

#include <algorithm>

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

// rows (3 x size) += or = g times three rows of C0: contiguous, so that it vectorises.
template <bool add, class Scalar>
void multiply_rows(const Scalar* g, const Scalar* source, std::size_t stride, std::size_t size,
                   Scalar* rows) {
  const Scalar* __restrict s0 = source, * __restrict s1 = source + stride, * __restrict s2 = source + 2 * stride;
  for (std::size_t i = 0; i < 3; ++i) {
    Scalar* __restrict row = rows + i * size;
    const Scalar a = g[i], b = g[4 + i], c = g[8 + i];
    for (std::size_t k = 0; k < size; ++k)
      row[k] = (add ? row[k] : Scalar(0)) + (a * s0[k] + b * s1[k] + c * s2[k]);
  }
}

// sum (3 x 4, the last column padding) += rows(:, three columns) g^T.
template <class Scalar>
void add_block(const Scalar* rows, std::size_t size, const Scalar* g, Scalar (&sum)[12]) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Scalar *r = rows + i * size, a = r[0], b = r[1], c = r[2];
    for (std::size_t q = 0; q < 4; ++q) sum[4 * i + q] += a * g[q] + b * g[4 + q] + c * g[8 + q];
  }
}

void add_scaled_block(const auto& block, double factor, double* target, std::size_t stride) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) target[i * stride + j] += factor * double(block[4 * i + j]);
}

}  // namespace

template <class Scalar>
void add_to_delassus(const ContactGeometry& body, const NodeCompliance<Scalar>& compliance,
                     double factor, std::span<double> delassus, DelassusWork<Scalar>& work) {
  const std::span<const Touch> touches = body.touches;
  const std::size_t stride = 3 * body.frames.size(), size = 3 * compliance.slot.size();
  contact_jacobians(body, work.jacobian);
  work.rows.resize(3 * size);
  const auto slot = [&](std::size_t t) {
    return 3 * std::size_t(compliance.slot[std::size_t(touches[t].node)]);
  };
  for (std::size_t i = 0, i_end; i < touches.size(); i = i_end) {
    i_end = group_end(touches, i);
    for (std::size_t t = i; t < i_end; ++t) {
      const Scalar* source = compliance.values + slot(t) * compliance.stride;
      if (t == i)
        multiply_rows<false>(&work.jacobian[12 * t], source, compliance.stride, size, work.rows.data());
      else
        multiply_rows<true>(&work.jacobian[12 * t], source, compliance.stride, size, work.rows.data());
    }
    double* row = delassus.data() + 3 * std::size_t(touches[i].contact) * stride;
    for (std::size_t j = 0, j_end; j <= i; j = j_end) {
      j_end = group_end(touches, j);
      Scalar sum[12] = {};
      for (std::size_t t = j; t < j_end; ++t)
        add_block(work.rows.data() + slot(t), size, &work.jacobian[12 * t], sum);
      add_scaled_block(sum, factor, row + 3 * std::size_t(touches[j].contact), stride);
    }
  }
}

template void add_to_delassus(const ContactGeometry&, const NodeCompliance<float>&, double,
                              std::span<double>, DelassusWork<float>&);
template void add_to_delassus(const ContactGeometry&, const NodeCompliance<double>&, double,
                              std::span<double>, DelassusWork<double>&);

// C_rigid between a and b is [I, A] diag(1/m, J^-1) [I, B]^T with A the cross product with a - centre.
void add_rigid_to_delassus(const ContactGeometry& body, const RigidModes& modes,
                           std::span<const Vec3> points, double factor, std::span<double> delassus,
                           DelassusWork<double>& work) {
  using Rows = Eigen::Map<Eigen::Matrix<double, 3, 6, Eigen::RowMajor>>;
  const std::size_t stride = 3 * body.frames.size();
  contact_jacobians(body, work.jacobian);
  work.rows.assign(18 * body.frames.size(), 0.0);
  const auto motions = [&](Index contact) { return Rows(&work.rows[18 * std::size_t(contact)]); };
  for (std::size_t t = 0; t < body.touches.size(); ++t) {
    const Eigen::Map<const Mat3, 0, Eigen::OuterStride<4>> g(&work.jacobian[12 * t]);
    auto rows = motions(body.touches[t].contact);
    rows.leftCols<3>() += g;
    const Vec3 arm = points[std::size_t(body.touches[t].node)] - modes.centre();
    for (int i = 0; i < 3; ++i) rows.block<1, 3>(i, 3) += g.row(i).cross(arm.transpose());
  }
  for (std::size_t i = 0, i_end; i < body.touches.size(); i = i_end) {
    i_end = group_end(body.touches, i);
    const auto left = motions(body.touches[i].contact);
    double* row = delassus.data() + 3 * std::size_t(body.touches[i].contact) * stride;
    for (std::size_t j = 0, j_end; j <= i; j = j_end) {
      j_end = group_end(body.touches, j);
      const auto right = motions(body.touches[j].contact);
      Eigen::Matrix<double, 3, 4, Eigen::RowMajor> block;
      block.leftCols<3>() =
          modes.inverse_mass() * left.leftCols<3>() * right.leftCols<3>().transpose() +
          left.rightCols<3>() * modes.inverse_inertia() * right.rightCols<3>().transpose();
      add_scaled_block(block.reshaped<Eigen::RowMajor>(), factor,
                       row + 3 * std::size_t(body.touches[j].contact), stride);
    }
  }
}

// By tiles, so that neither side strides through memory.
void mirror_delassus(std::size_t contact_count, std::span<double> delassus) {
  constexpr std::size_t tile = 16;
  const std::size_t size = 3 * contact_count;
  for (std::size_t row0 = 0; row0 < size; row0 += tile)
    for (std::size_t col0 = 0; col0 <= row0; col0 += tile)
      for (std::size_t row = row0; row < std::min(row0 + tile, size); ++row)
        for (std::size_t col = col0; col < std::min(col0 + tile, row); ++col)
          delassus[col * size + row] = delassus[row * size + col];
}

}  // namespace souple
