// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "formats/core/limits.hpp"
#include "formats/read/internal/checks.hpp"

namespace souple::checks {
namespace {

using Fault = std::optional<std::string>;

// Blocks and slots of a piece: what a plan may ask of the memory it runs in.
constexpr Index most_slots = 256;

std::string row_text(std::size_t row, const char* what) { return "row " + std::to_string(row) + what; }

/// `begin` cuts a list of `count` entries into `rows` rows.
Fault cut_fault(const std::vector<Index>& begin, std::size_t rows, std::size_t count,
                const std::string& name) {
  if (begin.size() != rows + 1)
    return name + " has " + std::to_string(begin.size()) + " beginnings of rows for " +
           std::to_string(rows) + " nodes";
  if (begin.front() != 0 || begin.back() < 0 || static_cast<std::size_t>(begin.back()) != count)
    return name + " does not span its list";
  const auto descent = std::ranges::is_sorted_until(begin);
  if (descent == begin.end()) return {};
  return name + ": " + row_text(static_cast<std::size_t>(descent - begin.begin()), " begins too early");
}

/// Ascending, each once, in range. Beginnings have to be sound.
Fault column_fault(const std::vector<Index>& begin, const std::vector<Index>& column, std::size_t count,
                   const std::string& name) {
  for (std::size_t row = 0; row + 1 < begin.size(); ++row) {
    Index before = -1;
    for (auto k = begin[row]; k < begin[row + 1]; ++k) {
      const Index c = column[static_cast<std::size_t>(k)];
      if (c <= before || static_cast<std::size_t>(c) >= count)
        return name + ": " + row_text(row, " names node ") + std::to_string(c) + " of " +
               std::to_string(count) + (c <= before ? ", not in order" : "");
      before = c;
    }
  }
  return {};
}

Fault weight_fault(const LevelTransition& transition) {
  if (transition.weight.size() != transition.column.size())
    return std::to_string(transition.weight.size()) + " weights for " +
           std::to_string(transition.column.size()) + " entries of the prolongation";
  for (std::size_t row = 0; row + 1 < transition.row_begin.size(); ++row) {
    const auto first = static_cast<std::size_t>(transition.row_begin[row]);
    const std::size_t count = static_cast<std::size_t>(transition.row_begin[row + 1]) - first;
    if (count < 1 || count > LevelTransition::width)
      return row_text(row, " of the prolongation has ") + std::to_string(count) +
             " entries, not 1 to 4";
    double sum = 0;
    for (const double w : std::span(transition.weight).subspan(first, count)) {
      // The negation also catches NaN.
      if (!(std::abs(w) <= limits::embedding_weight))
        return row_text(row, " of the prolongation has the weight ") + std::to_string(w);
      sum += w;
    }
    if (!(std::abs(sum - 1) <= limits::embedding_weight_sum))
      return row_text(row, " of the prolongation sums to ") + std::to_string(sum);
  }
  return {};
}

Fault diagonal_fault(const LevelTransition& transition) {
  for (std::size_t row = 0; row + 1 < transition.pattern_begin.size(); ++row) {
    const auto first = transition.pattern_column.begin() + transition.pattern_begin[row];
    const auto last = transition.pattern_column.begin() + transition.pattern_begin[row + 1];
    if (!std::binary_search(first, last, static_cast<Index>(row)))
      return row_text(row, " of the pattern has no diagonal block");
  }
  return {};
}

Fault piece_fault(const std::array<Index, 4>& piece, std::size_t number, std::size_t fine_nodes) {
  const auto [node, first, blocks, slots] = piece;
  const bool sound = node >= 0 && static_cast<std::size_t>(node) < fine_nodes && first >= 0 &&
                     blocks >= 1 && blocks <= most_slots && slots >= 1 && slots <= most_slots;
  if (sound) return {};
  return "piece " + std::to_string(number) + " of the plan is {" + std::to_string(node) + ", " +
         std::to_string(first) + ", " + std::to_string(blocks) + ", " + std::to_string(slots) + "}";
}

/// Every slot that a block is added to is one of its piece.
Fault slot_fault(const LevelTransition& transition, std::size_t fine_nodes) {
  std::size_t slot = 0, target = 0;
  for (std::size_t p = 0; p < transition.pieces.size(); ++p) {
    if (Fault fault = piece_fault(transition.pieces[p], p, fine_nodes)) return fault;
    const auto blocks = static_cast<std::size_t>(transition.pieces[p][2]);
    const auto slots = static_cast<std::size_t>(transition.pieces[p][3]);
    if (blocks > transition.slots.size() - slot || slots > transition.targets.size() - target)
      return "piece " + std::to_string(p) + " of the plan goes beyond its lists";
    for (const auto& row : std::span(transition.slots).subspan(slot, blocks))
      for (const std::uint8_t s : row)
        if (s >= slots)
          return "piece " + std::to_string(p) + " of the plan names slot " + std::to_string(s) +
                 " of " + std::to_string(slots);
    slot += blocks;
    target += slots;
  }
  if (slot != transition.slots.size() || target != transition.targets.size())
    return "the pieces of the plan do not use up its lists";
  return {};
}

Fault target_fault(const LevelTransition& transition) {
  for (const auto& row : transition.targets)
    for (const Index target : row)
      if (target < 0 || static_cast<std::size_t>(target) >= transition.pattern_column.size())
        return "the plan names coarse block " + std::to_string(target) + " of " +
               std::to_string(transition.pattern_column.size());
  return {};
}

Fault first_fault(const LevelTransition& t, std::size_t fine_nodes, std::size_t coarse_nodes) {
  if (Fault fault = cut_fault(t.row_begin, fine_nodes, t.column.size(), "the prolongation"))
    return fault;
  if (Fault fault = column_fault(t.row_begin, t.column, coarse_nodes, "the prolongation")) return fault;
  if (Fault fault = weight_fault(t)) return fault;
  if (Fault fault = cut_fault(t.pattern_begin, coarse_nodes, t.pattern_column.size(), "the pattern"))
    return fault;
  if (Fault fault = column_fault(t.pattern_begin, t.pattern_column, coarse_nodes, "the pattern"))
    return fault;
  if (Fault fault = diagonal_fault(t)) return fault;
  if (Fault fault = slot_fault(t, fine_nodes)) return fault;
  return target_fault(t);
}

}  // namespace

void check_transition(const LevelTransition& transition, std::size_t fine_nodes,
                      std::size_t coarse_nodes, const std::string& where, IssueList& issues) {
  if (const Fault fault = first_fault(transition, fine_nodes, coarse_nodes))
    issues.add(IssueCode::asset_multigrid_invalid, where, [&] { return *fault; });
}

}  // namespace souple::checks
