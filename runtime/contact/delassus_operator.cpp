// SPDX-License-Identifier: MIT
#include "runtime/contact/delassus_operator.hpp"

#include <algorithm>

namespace souple {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Strided = Eigen::Map<RowMajor3, 0, Eigen::OuterStride<>>;
using ConstStrided = Eigen::Map<const RowMajor3, 0, Eigen::OuterStride<>>;

// The touches of one contact: [first, last).
std::size_t group_end(std::span<const Touch> touches, std::size_t first) {
  std::size_t last = first + 1;
  while (last < touches.size() && touches[last].contact == touches[first].contact) ++last;
  return last;
}

// rows (3 x 3c) = F^T sum of weight C(node, :): the contact's Jacobian times the compliance.
void jacobian_times_compliance(std::span<const Touch> group, const Mat3& frame,
                               std::span<const double> compliance, std::size_t size, double* rows) {
  std::fill(rows, rows + 3 * size, 0.0);
  for (const Touch& touch : group)
    for (int k = 0; k < 3; ++k) {
      const double* source = compliance.data() + (3 * std::size_t(touch.node) + std::size_t(k)) * size;
      const double f0 = touch.weight * frame(k, 0), f1 = touch.weight * frame(k, 1),
                   f2 = touch.weight * frame(k, 2);
      for (std::size_t c = 0; c < size; ++c) {
        rows[c] += f0 * source[c];
        rows[size + c] += f1 * source[c];
        rows[2 * size + c] += f2 * source[c];
      }
    }
}

}  // namespace

void warp_compliance(std::span<const Mat3> rotations, std::span<double> compliance) {
  const std::size_t count = rotations.size(), size = 3 * count;
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      Strided block(compliance.data() + 3 * a * size + 3 * b, Eigen::OuterStride<>(Eigen::Index(size)));
      const Mat3 turned = rotations[a] * block * rotations[b].transpose();
      block = turned;
      if (a != b)
        Strided(compliance.data() + 3 * b * size + 3 * a, Eigen::OuterStride<>(Eigen::Index(size))) =
            turned.transpose();
    }
}

void add_to_delassus(std::span<const Touch> touches, std::span<const Mat3> frames,
                     std::span<const double> compliance, std::size_t contact_count,
                     std::span<double> delassus, std::span<double> row_work) {
  const std::size_t stride = 3 * contact_count, size = row_work.size() / 3;
  for (std::size_t i = 0, i_end; i < touches.size(); i = i_end) {
    i_end = group_end(touches, i);
    const auto row = std::size_t(touches[i].contact);
    jacobian_times_compliance(touches.subspan(i, i_end - i), frames[row], compliance, size,
                              row_work.data());
    for (std::size_t j = 0, j_end; j <= i; j = j_end) {
      j_end = group_end(touches, j);
      const auto col = std::size_t(touches[j].contact);
      Mat3 sum = Mat3::Zero();
      for (std::size_t q = j; q < j_end; ++q)
        sum += touches[q].weight * ConstStrided(row_work.data() + 3 * std::size_t(touches[q].node),
                                                Eigen::OuterStride<>(Eigen::Index(size)));
      Strided(delassus.data() + 3 * row * stride + 3 * col, Eigen::OuterStride<>(Eigen::Index(stride)))
          .noalias() += sum * frames[col];
    }
  }
}

void mirror_delassus(std::size_t contact_count, std::span<double> delassus) {
  const std::size_t size = 3 * contact_count;
  for (std::size_t row = 0; row < size; ++row)
    for (std::size_t col = 0; col < row; ++col) delassus[col * size + row] = delassus[row * size + col];
}

}  // namespace souple
