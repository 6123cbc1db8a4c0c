// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <vector>

#include "runtime/contact/delassus_operator.hpp"
#include "runtime/contact/padded_columns.hpp"

namespace souple {

/// What one soft body adds to the Delassus operator, over its own contacts: a dense symmetric matrix in
/// single precision, and the part of the gaps that it causes: a base in double, made from all forces at
/// once, and in single what they changed since.
class DelassusBlock {
 public:
  /// Zero, for so many contacts.
  void resize(std::size_t contact_count);
  /// Its lower block triangle is filled before finish().
  DelassusTarget<float> values() { return {columns_.column(0), columns_.stride()}; }
  void finish() { mirror_delassus(columns_.width() / 3, values()); }

  const PaddedColumns& columns() const { return columns_; }
  Mat3 diagonal_block(std::size_t i) const { return columns_.block(i, i); }
  void clear_gap();
  Vec3 gap(std::size_t i) const {
    const double* b = base_.data() + 3 * i;
    const float* d = increment_.data() + offset_ + 3 * i;
    return {b[0] + double(d[0]), b[1] + double(d[1]), b[2] + double(d[2])};
  }
  void add_influence(std::size_t i, const Vec3& change) {
    columns_.add_product(i, change, increment_.data() + offset_);
  }
  /// The same in double.
  void add_to_base(std::size_t i, const Vec3& force) { columns_.add_product(i, force, base_.data()); }

 private:
  PaddedColumns columns_;
  std::vector<double> base_;
  std::vector<float> increment_;
  std::size_t offset_ = 0;
};

}  // namespace souple
