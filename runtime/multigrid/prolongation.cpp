// SPDX-License-Identifier: MIT
#include "runtime/multigrid/prolongation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "formats/core/limits.hpp"

namespace souple {
namespace {

constexpr double least_weight = 1e-12;

struct Entry {
  Index column;
  double weight;
};

Issue row_issue(IssueCode code, std::size_t row, const std::string& what) {
  return make_issue(code, "row " + std::to_string(row) + " of the prolongation " + what);
}

/// Appends a row: columns ascend, each once, negligible weights are dropped and the largest one takes
/// what is missing to 1, so that translations are carried exactly.
template <std::size_t N>
void append_row(std::array<Entry, N> entries, Prolongation& p) {
  std::ranges::sort(entries, {}, &Entry::column);
  const std::size_t begin = p.column.size();
  for (const Entry& entry : entries) {
    if (std::abs(entry.weight) < least_weight) continue;
    if (p.column.size() > begin && p.column.back() == entry.column) {
      p.weight.back() += entry.weight;
    } else {
      p.column.push_back(entry.column);
      p.weight.push_back(entry.weight);
    }
  }
  const auto first = p.weight.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto magnitude = [](double w) { return std::abs(w); };
  const auto largest = std::ranges::max_element(first, p.weight.end(), {}, magnitude);
  double others = 0;
  for (auto w = first; w != p.weight.end(); ++w)
    if (w != largest) others += *w;
  *largest = 1 - others;
  p.row_begin.push_back(static_cast<Index>(p.column.size()));
}

Status append_embedded_row(std::size_t row, const Embedding& place, const TetMesh& coarse,
                           Prolongation& p) {
  if (place.tet < 0 || static_cast<std::size_t>(place.tet) >= coarse.tets.size())
    return row_issue(
        IssueCode::asset_index_out_of_range, row,
        "names tet " + std::to_string(place.tet) + " of " + std::to_string(coarse.tets.size()));
  const Tet& tet = coarse.tets[static_cast<std::size_t>(place.tet)];
  std::array<Entry, 4> entries{};
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (tet[k] < 0 || tet[k] >= p.coarse_count)
      return row_issue(
          IssueCode::asset_index_out_of_range, row,
          "hangs on node " + std::to_string(tet[k]) + " of " + std::to_string(p.coarse_count));
    // Written so that NaN is refused.
    if (!(std::abs(place.weights[k]) <= limits::embedding_weight))
      return row_issue(IssueCode::asset_embedding_invalid, row,
                       "has the weight " + std::to_string(place.weights[k]));
    entries[k] = {tet[k], place.weights[k]};
    sum += place.weights[k];
  }
  if (std::abs(sum - 1) > limits::embedding_weight_sum)
    return row_issue(IssueCode::asset_embedding_invalid, row, "sums to " + std::to_string(sum));
  append_row(entries, p);
  return {};
}

Status append_nested_row(std::size_t row, const std::array<Index, 2>& parents, Prolongation& p) {
  for (const Index parent : parents)
    if (parent < 0 || parent >= p.coarse_count)
      return row_issue(
          IssueCode::asset_index_out_of_range, row,
          "hangs on node " + std::to_string(parent) + " of " + std::to_string(p.coarse_count));
  append_row(std::array<Entry, 2>{{{parents[0], 0.5}, {parents[1], 0.5}}}, p);
  return {};
}

}  // namespace

Result<Prolongation> prolongation_of(const MeshLevel& fine, const MeshLevel& coarse) {
  const std::size_t count = fine.mesh.nodes.size();
  const bool embedded = !fine.embedding.empty();
  const std::size_t rows = embedded ? fine.embedding.size() : fine.parents.size();
  if (rows != count)
    return make_issue(IssueCode::asset_embedding_invalid,
                      std::to_string(rows) + (embedded ? " embedding rows" : " rows of parents") +
                          " for " + std::to_string(count) + " nodes");
  Prolongation p;
  p.coarse_count = static_cast<Index>(coarse.mesh.nodes.size());
  p.row_begin.reserve(count + 1);
  p.column.reserve((embedded ? 4 : 2) * count);
  p.weight.reserve((embedded ? 4 : 2) * count);
  p.row_begin.push_back(0);
  for (std::size_t row = 0; row < count; ++row) {
    const Status appended = embedded ? append_embedded_row(row, fine.embedding[row], coarse.mesh, p)
                                     : append_nested_row(row, fine.parents[row], p);
    if (!appended) return appended.issue();
  }
  return p;
}

Prolongation prolongation_of(const LevelTransition& stored) {
  return {static_cast<Index>(stored.pattern_begin.size()) - 1, stored.row_begin, stored.column,
          stored.weight};
}

Prolongation without_rows(const Prolongation& p, std::span<const Index> fixed) {
  std::vector<bool> is_fixed(static_cast<std::size_t>(p.fine_count()), false);
  for (const Index node : fixed) is_fixed[static_cast<std::size_t>(node)] = true;
  Prolongation moving;
  moving.coarse_count = p.coarse_count;
  moving.row_begin.reserve(p.row_begin.size());
  moving.column.reserve(p.column.size());
  moving.weight.reserve(p.weight.size());
  moving.row_begin.push_back(0);
  for (Index row = 0; row < p.fine_count(); ++row) {
    const auto first = p.row_begin[std::size_t(row)], last = p.row_begin[std::size_t(row) + 1];
    if (!is_fixed[static_cast<std::size_t>(row)]) {
      moving.column.insert(moving.column.end(), p.column.begin() + first, p.column.begin() + last);
      moving.weight.insert(moving.weight.end(), p.weight.begin() + first, p.weight.begin() + last);
    }
    moving.row_begin.push_back(static_cast<Index>(moving.column.size()));
  }
  return moving;
}

void prolong(const Prolongation& p, const Eigen::VectorXf& coarse, Eigen::VectorXf& fine) {
  for (std::size_t row = 0; row + 1 < p.row_begin.size(); ++row) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (auto k = std::size_t(p.row_begin[row]); k < std::size_t(p.row_begin[row + 1]); ++k)
      sum += float(p.weight[k]) * coarse.segment<3>(3 * Eigen::Index{p.column[k]});
    fine.segment<3>(3 * Eigen::Index(row)) = sum;
  }
}

void restrict_to(const Prolongation& p, const Eigen::VectorXf& fine, Eigen::VectorXf& coarse) {
  coarse.setZero();
  for (std::size_t row = 0; row + 1 < p.row_begin.size(); ++row) {
    const Eigen::Vector3f value = fine.segment<3>(3 * Eigen::Index(row));
    for (auto k = std::size_t(p.row_begin[row]); k < std::size_t(p.row_begin[row + 1]); ++k)
      coarse.segment<3>(3 * Eigen::Index{p.column[k]}) += float(p.weight[k]) * value;
  }
}

}  // namespace souple
