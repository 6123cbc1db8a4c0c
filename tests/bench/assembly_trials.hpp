// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to assemble and to multiply that were measured against the shipped ones.
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "runtime/fem/corotational_model.hpp"

namespace souple::bench {

/// Tet after tet: all sixteen blocks of R K_e R^T added to where they belong, by a stored plan.
class ScatteredAssembly {
 public:
  ScatteredAssembly(const CorotationalModel& model, double lambda_over_mu)
      : model_(model), ratio_(lambda_over_mu) {
    for (const Tet& tet : model.tets()) {
      std::array<Index, 16> places{};
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) places[4 * i + j] = model.pattern().find(tet[i], tet[j]);
      places_.push_back(places);
    }
  }

  void assemble(double mass_factor, double factor, const CornerVectors& gradients,
                BlockMatrix& out) const {
    std::ranges::fill(out.values, 0.0);
    for (std::size_t node = 0; node < model_.masses().size(); ++node)
      out.block(out.pattern->diagonal[node])
          .diagonal()
          .setConstant(mass_factor * model_.masses()[node]);
    for (std::size_t t = 0; t < places_.size(); ++t)
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i; j < 4; ++j) {
          const Vec3 a = corner(gradients, 4 * t + i), b = corner(gradients, 4 * t + j);
          Mat3 block = (factor * ratio_ * a) * b.transpose();
          block.noalias() += (factor * b) * a.transpose();
          block.diagonal().array() += factor * a.dot(b);
          out.block(places_[t][4 * i + j]) += block;
          if (i != j) out.block(places_[t][4 * j + i]) += block.transpose();
        }
  }

 private:
  static Vec3 corner(const CornerVectors& from, std::size_t k) { return Vec3(from[k].entry); }

  const CorotationalModel& model_;
  double ratio_;
  std::vector<std::array<Index, 16>> places_;
};

/// Row after row: every incident tet adds three outer products to a row that stays in the cache; both
/// triangles are computed.
class RowAssembly {
 public:
  RowAssembly(const CorotationalModel& model, double lambda_over_mu)
      : model_(model), ratio_(lambda_over_mu), begin_(model.masses().size() + 1, 0) {
    const BlockPattern& pattern = model.pattern();
    std::vector<std::vector<Incident>> rows(model.masses().size());
    dots_.assign(pattern.block_count(), 0.0);
    CornerVectors rest = model.make_corner_vectors();
    model.elements().gradients(nullptr, model.elements().all_packs(), rest.data());
    for (std::size_t t = 0; t < model.tets().size(); ++t)
      for (std::size_t i = 0; i < 4; ++i) {
        const Tet& tet = model.tets()[t];
        Incident incident{Index(4 * t + i), {}, {}};
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t j = (i + k + 1) % 4;
          const Index place = pattern.find(tet[i], tet[j]);
          incident.other[k] = Index(4 * t + j);
          incident.slot[k] = place - pattern.row_begin[tet[i]];
          dots_[std::size_t(place)] += Vec3(rest[4 * t + i].entry).dot(Vec3(rest[4 * t + j].entry));
        }
        rows[std::size_t(tet[i])].push_back(incident);
      }
    for (std::size_t row = 0; row < rows.size(); ++row) {
      incidents_.insert(incidents_.end(), rows[row].begin(), rows[row].end());
      begin_[row + 1] = Index(incidents_.size());
      longest_ = std::max(longest_, pattern.row_begin[row + 1] - pattern.row_begin[row]);
    }
    row_.resize(std::size_t(longest_));
  }

  void assemble(double mass_factor, double factor, const CornerVectors& gradients, BlockMatrix& out) {
    const BlockPattern& pattern = *out.pattern;
    for (Index row = 0; row < pattern.node_count(); ++row) {
      const Index first = pattern.row_begin[row], count = pattern.row_begin[row + 1] - first;
      std::fill_n(row_.begin(), count, Outer{});
      for (Index k = begin_[row]; k < begin_[row + 1]; ++k) add(incidents_[k], gradients);
      Mat3 sum = Mat3::Zero();
      for (Index slot = 0; slot < count; ++slot) {
        if (first + slot == pattern.diagonal[row]) continue;
        const auto p = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(
                           row_[std::size_t(slot)].entry)
                           .leftCols<3>();
        Mat3 block = factor * ratio_ * p + factor * p.transpose();
        block.diagonal().array() += factor * dots_[std::size_t(first + slot)];
        out.block(first + slot) = block;
        sum -= block;
      }
      sum.diagonal().array() += mass_factor * model_.masses()[std::size_t(row)];
      out.block(pattern.diagonal[row]) = 0.5 * (sum + sum.transpose());
    }
  }

 private:
  struct alignas(32) Outer {
    double entry[12];
  };
  struct Incident {
    Index own;
    std::array<Index, 3> other, slot;
  };

  void add(const Incident& incident, const CornerVectors& gradients) {
    const CornerVector& gi = gradients[std::size_t(incident.own)];
    for (std::size_t k = 0; k < 3; ++k) {
      const Lanes gj = _mm256_load_pd(gradients[std::size_t(incident.other[k])].entry);
      double* to = row_[std::size_t(incident.slot[k])].entry;
      for (int r = 0; r < 3; ++r)
        _mm256_store_pd(to + 4 * r,
                        fma(_mm256_broadcast_sd(&gi.entry[r]), gj, _mm256_load_pd(to + 4 * r)));
    }
  }

  const CorotationalModel& model_;
  double ratio_;
  std::vector<Index> begin_;
  std::vector<Incident> incidents_;
  std::vector<double> dots_;
  std::vector<Outer> row_;
  Index longest_ = 0;
};

/// y = A x from the blocks on and above the diagonal alone: half the memory, but y is written many
/// times.
inline void multiply_half(const BlockMatrix& a, const double* x, double* y) {
  const BlockPattern& pattern = *a.pattern;
  std::fill_n(y, 3 * std::size_t(pattern.node_count()), 0.0);
  for (Index row = 0; row < pattern.node_count(); ++row) {
    const double* xi = x + 3 * std::size_t(row);
    const Lanes x0 = all_lanes(xi[0]), x1 = all_lanes(xi[1]), x2 = all_lanes(xi[2]), v = load3(xi);
    const double* block = a.values.data() + 9 * std::size_t(pattern.diagonal[row]);
    Lanes sum[4] = {_mm256_loadu_pd(block) * v, _mm256_loadu_pd(block + 3) * v, load3(block + 6) * v,
                    zero_lanes()};
    for (Index b = pattern.diagonal[row] + 1; b < pattern.row_begin[row + 1]; ++b) {
      block += 9;
      const Lanes r0 = _mm256_loadu_pd(block), r1 = _mm256_loadu_pd(block + 3), r2 = load3(block + 6);
      const std::size_t column = 3 * std::size_t(pattern.column[b]);
      const Lanes xj = load3(x + column);
      sum[0] = fma(r0, xj, sum[0]);
      sum[1] = fma(r1, xj, sum[1]);
      sum[2] = fma(r2, xj, sum[2]);
      store3(y + column, fma(r0, x0, fma(r1, x1, fma(r2, x2, load3(y + column)))));
    }
    transpose(sum[0], sum[1], sum[2], sum[3]);
    const Lanes own = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    store3(y + 3 * std::size_t(row), load3(y + 3 * std::size_t(row)) + own);
  }
}

}  // namespace souple::bench
