// SPDX-License-Identifier: MIT
#include "runtime/compliance/prolonged_compliance.hpp"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

// Far beyond what extrapolation outside a coarse tet gives.
constexpr double largest_weight = 1e3;

// The coarse rows behind some rows, ascending, each once.
void collect_coarse(std::span<const RowProlongation> prolongation, std::span<const Index> rows,
                    std::vector<Index>& coarse) {
  coarse.clear();
  for (const Index row : rows)
    for (const Index other : prolongation[std::size_t(row)].row) coarse.push_back(other);
  std::ranges::sort(coarse);
  coarse.erase(std::unique(coarse.begin(), coarse.end()), coarse.end());
}

std::size_t place_of(Index row, const std::vector<Index>& sorted) {
  return std::size_t(std::ranges::lower_bound(sorted, row) - sorted.begin());
}

// half (3 |rows| x size) = P(rows, :) coarse, with `coarse` over the places of `coarse_rows`.
void prolong_rows(std::span<const RowProlongation> prolongation, std::span<const Index> rows,
                  const std::vector<Index>& coarse_rows, const float* coarse, std::size_t size,
                  float* half) {
  std::fill(half, half + 3 * rows.size() * size, 0.0F);
  for (std::size_t a = 0; a < rows.size(); ++a) {
    const RowProlongation& p = prolongation[std::size_t(rows[a])];
    for (std::size_t q = 0; q < 4; ++q) {
      if (p.weight[q] == 0) continue;
      const auto weight = float(p.weight[q]);
      const float* source = coarse + 3 * place_of(p.row[q], coarse_rows) * size;
      float* target = half + 3 * a * size;
      for (std::size_t k = 0; k < 3 * size; ++k) target[k] += weight * source[k];
    }
  }
}

// One 3x3 block of half P^T: `half` points to three rows of `size`, and place[q] is a coarse node.
void prolong_block(const float* half, std::size_t size, const RowProlongation& p,
                   const std::array<std::size_t, 4>& place, float (&block)[3][3]) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      float sum = 0;
      for (std::size_t q = 0; q < 4; ++q) sum += float(p.weight[q]) * half[i * size + 3 * place[q] + j];
      block[i][j] = sum;
    }
}

void make_symmetric(float (&block)[3][3]) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < i; ++j) block[j][i] = block[i][j];
}

std::array<std::size_t, 4> places_of(const RowProlongation& p, const std::vector<Index>& sorted) {
  std::array<std::size_t, 4> place{};
  for (std::size_t q = 0; q < 4; ++q) place[q] = place_of(p.row[q], sorted);
  return place;
}

}  // namespace

ProlongedCompliance::ProlongedCompliance(std::unique_ptr<const RestCompliance> coarse,
                                         std::vector<RowProlongation> prolongation)
    : coarse_(std::move(coarse)), prolongation_(std::move(prolongation)) {}

Result<std::unique_ptr<const RestCompliance>> ProlongedCompliance::create(
    std::unique_ptr<const RestCompliance> coarse, std::vector<RowProlongation> prolongation,
    const std::string& where) {
  if (prolongation.empty())
    return make_issue(IssueCode::asset_corrupt, "a coarse compliance without prolongation", where);
  for (std::size_t row = 0; row < prolongation.size(); ++row)
    for (std::size_t q = 0; q < 4; ++q) {
      const Index other = prolongation[row].row[q];
      const double weight = prolongation[row].weight[q];
      if (other < 0 || other >= coarse->row_count() || !(std::abs(weight) <= largest_weight))
        return make_issue(IssueCode::asset_corrupt,
                          "prolongation " + std::to_string(row) + " names row " +
                              std::to_string(other) + " of " + std::to_string(coarse->row_count()) +
                              " with weight " + std::to_string(weight),
                          where);
    }
  return std::unique_ptr<const RestCompliance>(
      new ProlongedCompliance(std::move(coarse), std::move(prolongation)));
}

// All rows are asked, so that a streaming source learns of everything that is missing.
bool ProlongedCompliance::ready(std::span<const Index> rows) const {
  bool all = true;
  for (const Index row : rows) all = coarse_->ready(prolongation_[std::size_t(row)].row) && all;
  return all;
}

bool ProlongedCompliance::ready_to_apply(std::span<const Index> rows) const {
  bool all = true;
  for (const Index row : rows)
    all = coarse_->ready_to_apply(prolongation_[std::size_t(row)].row) && all;
  return all;
}

void ProlongedCompliance::gather(std::span<const Index> rows, std::span<double> out) const {
  ComplianceWork work;
  std::vector<float> block(out.size());
  gather_block(rows, rows, block.data(), 3 * rows.size(), work);
  std::ranges::copy(block, out.begin());
}

// (P_r C) P_c^T and (P_c C) P_r^T round differently: a pair is prolonged from its larger row first,
// whichever side that is on, so that the blocks of a pair are transposes to the bit.
void ProlongedCompliance::gather_block(std::span<const Index> rows, std::span<const Index> columns,
                                       float* out, std::size_t stride, ComplianceWork& work) const {
  collect_coarse(prolongation_, rows, work.coarse_rows);
  collect_coarse(prolongation_, columns, work.coarse_columns);
  const std::size_t row_size = 3 * work.coarse_rows.size(),
                    column_size = 3 * work.coarse_columns.size();
  const auto evaluate = [&](std::span<const Index> first, const std::vector<Index>& coarse_first,
                            std::span<const Index> second, const std::vector<Index>& coarse_second,
                            bool transposed) {
    const std::size_t size = 3 * coarse_second.size();
    work.coarse_block.resize(row_size * column_size);
    work.half_block.resize(3 * first.size() * size);
    coarse_->gather_block(coarse_first, coarse_second, work.coarse_block.data(), size, work);
    prolong_rows(prolongation_, first, coarse_first, work.coarse_block.data(), size,
                 work.half_block.data());
    for (std::size_t b = 0; b < second.size(); ++b) {
      const RowProlongation& p = prolongation_[std::size_t(second[b])];
      const auto place = places_of(p, coarse_second);
      for (std::size_t a = 0; a < first.size(); ++a) {
        if (transposed ? first[a] <= second[b] : first[a] < second[b]) continue;
        float block[3][3];
        prolong_block(work.half_block.data() + 3 * a * size, size, p, place, block);
        if (first[a] == second[b]) make_symmetric(block);
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j)
            out[transposed ? (3 * b + j) * stride + 3 * a + i : (3 * a + i) * stride + 3 * b + j] =
                block[i][j];
      }
    }
  };
  evaluate(rows, work.coarse_rows, columns, work.coarse_columns, false);
  evaluate(columns, work.coarse_columns, rows, work.coarse_rows, true);
}

void ProlongedCompliance::apply(std::span<const Index> rows, std::span<const double> force,
                                std::span<double> displacement, ComplianceWork& work) const {
  collect_coarse(prolongation_, rows, work.coarse_rows);
  work.coarse_force.assign(3 * work.coarse_rows.size(), 0.0);
  for (std::size_t a = 0; a < rows.size(); ++a) {
    const RowProlongation& p = prolongation_[std::size_t(rows[a])];
    for (std::size_t q = 0; q < 4; ++q) {
      double* target = work.coarse_force.data() + 3 * place_of(p.row[q], work.coarse_rows);
      for (std::size_t k = 0; k < 3; ++k) target[k] += p.weight[q] * force[3 * a + k];
    }
  }
  work.coarse_motion.resize(3 * std::size_t(coarse_->row_count()));
  coarse_->apply(work.coarse_rows, work.coarse_force, work.coarse_motion, work);
  for (std::size_t row = 0; row < prolongation_.size(); ++row) {
    const RowProlongation& p = prolongation_[row];
    for (std::size_t k = 0; k < 3; ++k) {
      double sum = 0;
      for (std::size_t q = 0; q < 4; ++q)
        sum += p.weight[q] * work.coarse_motion[3 * std::size_t(p.row[q]) + k];
      displacement[3 * row + k] = sum;
    }
  }
}

std::size_t ProlongedCompliance::resident_bytes() const {
  return coarse_->resident_bytes() + prolongation_.size() * sizeof(RowProlongation);
}

}  // namespace souple
