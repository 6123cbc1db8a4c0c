// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/hierarchy/wavelet.hpp"

#include <algorithm>
#include <cassert>
#include <string>

namespace souple {
namespace {

Issue invalid(std::size_t level, const std::string& what) {
  return make_issue(IssueCode::asset_hierarchy_invalid, what, "level " + std::to_string(level + 1));
}

/// The node of the level that keeps each coarse node.
Result<std::vector<std::size_t>> kept_nodes(const ParentRows& rows, std::size_t coarse_count,
                                            std::size_t level) {
  std::vector<std::size_t> kept(coarse_count, rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto [a, b] = rows[i];
    if (std::min(a, b) < 0 || static_cast<std::size_t>(std::max(a, b)) >= coarse_count)
      return invalid(level, "node " + std::to_string(i) + " has a parent outside the coarser level");
    if (a != b) continue;
    std::size_t& node = kept[static_cast<std::size_t>(a)];
    if (node != rows.size()) return invalid(level, "node " + std::to_string(a) + " is kept twice");
    node = i;
  }
  const auto lost = std::ranges::find(kept, rows.size());
  if (lost != kept.end())
    return invalid(level, "node " + std::to_string(lost - kept.begin()) + " is not kept");
  return kept;
}

}  // namespace

Result<NestedWavelet> NestedWavelet::make(std::vector<ParentRows> levels,
                                          std::size_t coarse_node_count) {
  // Where the nodes of the level at hand are among those of the finest one, from the finest downwards.
  NestedWavelet wavelet;
  wavelet.node_count_ = levels.empty() ? coarse_node_count : levels.back().size();
  std::vector<std::size_t> place(wavelet.node_count_);
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = i;
  for (std::size_t l = levels.size(); l-- > 0;) {
    const ParentRows& rows = levels[l];
    const std::size_t coarse_count = l == 0 ? coarse_node_count : levels[l - 1].size();
    if (coarse_count > rows.size())
      return invalid(l, "there are fewer nodes than on the coarser level");
    const auto kept = kept_nodes(rows, coarse_count, l);
    if (!kept) return kept.issue();
    std::vector<Midpoint> midpoints;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto [a, b] = rows[i];
      if (a == b) continue;
      midpoints.push_back({place[i], place[(*kept)[static_cast<std::size_t>(a)]],
                           place[(*kept)[static_cast<std::size_t>(b)]]});
    }
    wavelet.levels_.push_back(std::move(midpoints));
    std::vector<std::size_t> coarse_place(coarse_count);
    for (std::size_t i = 0; i < coarse_count; ++i) coarse_place[i] = place[(*kept)[i]];
    place = std::move(coarse_place);
  }
  std::ranges::reverse(wavelet.levels_);
  return wavelet;
}

std::size_t NestedWavelet::node_count() const { return node_count_; }

void NestedWavelet::forward(std::span<double> values, std::size_t components) const {
  assert(values.size() == node_count_ * components);
  for (std::size_t l = levels_.size(); l-- > 0;)
    for (const Midpoint& m : levels_[l])
      for (std::size_t c = 0; c < components; ++c)
        values[m.node * components + c] -=
            0.5 * (values[m.a * components + c] + values[m.b * components + c]);
}

void NestedWavelet::inverse(std::span<double> values, std::size_t components) const {
  assert(values.size() == node_count_ * components);
  for (const auto& level : levels_)
    for (const Midpoint& m : level)
      for (std::size_t c = 0; c < components; ++c)
        values[m.node * components + c] +=
            0.5 * (values[m.a * components + c] + values[m.b * components + c]);
}

}  // namespace souple
