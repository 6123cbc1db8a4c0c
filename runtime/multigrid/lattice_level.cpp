// SPDX-License-Identifier: MIT
#include "runtime/multigrid/lattice_level.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstdint>

namespace souple {
namespace {

/// Weights below this are rounding: a node that stands on a face of a tet.
constexpr double least_weight = 1e-6;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

using Corner = std::array<std::int32_t, 3>;

struct Hold {
  Corner corner;  ///< of the lattice
  Index node;
  double weight;
};

/// Along the path of a Freudenthal tet: from the lowest corner of the cell one step per axis, in the
/// order of falling local coordinates.
void append_holds(const Point& p, Index node, const Lattice& lattice, std::vector<Hold>& holds) {
  Corner corner;
  std::array<double, 3> local;
  std::array<std::size_t, 3> axis{0, 1, 2};
  for (std::size_t k = 0; k < 3; ++k) {
    const double place = (p[k] - lattice.origin[k]) / lattice.spacing;
    const double cell = std::floor(place + least_weight);
    corner[k] = static_cast<std::int32_t>(cell);
    local[k] = std::max(place - cell, 0.0);
  }
  std::ranges::stable_sort(axis, std::greater{}, [&](std::size_t k) { return local[k]; });
  double above = 1, held = 0;
  const std::size_t first = holds.size();
  for (std::size_t step = 0; step <= 3; ++step) {
    const double below = step < 3 ? local[axis[step]] : 0;
    if (above - below > least_weight) holds.push_back({corner, node, above - below});
    if (step < 3) ++corner[axis[step]];
    above = below;
  }
  for (std::size_t k = first; k < holds.size(); ++k) held += holds[k].weight;
  for (std::size_t k = first; k < holds.size(); ++k) holds[k].weight /= held;
}

/// Numbers the connected parts of the nodes of every corner.
class Parts {
 public:
  Parts(const BlockPattern& pattern)
      : pattern_(pattern), corner_(pattern.diagonal.size(), -1), part_(pattern.diagonal.size()) {}

  /// Calls see(hold, part) for all of the holds of one corner; parts count from `first`. Returns the
  /// next free number.
  template <class See>
  Index number(std::span<const Hold> holds, Index first, See&& see) {
    const Index stamp = first;
    for (const Hold& hold : holds) {
      corner_[at(hold.node)] = stamp;
      part_[at(hold.node)] = -1;
    }
    for (const Hold& hold : holds) {
      if (part_[at(hold.node)] < 0) spread(hold.node, stamp, first++);
      see(hold, part_[at(hold.node)]);
    }
    return first;
  }

 private:
  void spread(Index start, Index stamp, Index part) {
    front_.assign(1, start);
    part_[at(start)] = part;
    while (!front_.empty()) {
      const Index node = front_.back();
      front_.pop_back();
      for (Index b = pattern_.row_begin[at(node)]; b < pattern_.row_begin[at(node) + 1]; ++b) {
        const Index other = pattern_.column[at(b)];
        if (corner_[at(other)] != stamp || part_[at(other)] >= 0) continue;
        part_[at(other)] = part;
        front_.push_back(other);
      }
    }
  }

  const BlockPattern& pattern_;
  std::vector<Index> corner_, part_;  ///< of every node: the last corner that asked, its part there
  std::vector<Index> front_;
};

struct Entry {
  Index row, column;
  double weight;
};

Prolongation from_entries(std::vector<Entry> entries, Index rows, Index columns) {
  Prolongation p;
  p.coarse_count = columns;
  p.row_begin.assign(at(rows) + 1, 0);
  for (const Entry& entry : entries) ++p.row_begin[at(entry.row) + 1];
  for (std::size_t row = 0; row < at(rows); ++row) p.row_begin[row + 1] += p.row_begin[row];
  p.column.resize(entries.size());
  p.weight.resize(entries.size());
  // Entries come by column, so that columns ascend in every row.
  std::vector<Index> next(p.row_begin.begin(), p.row_begin.end() - 1);
  for (const Entry& entry : entries) {
    const Index place = next[at(entry.row)]++;
    p.column[at(place)] = entry.column;
    p.weight[at(place)] = entry.weight;
  }
  return p;
}

}  // namespace

LatticeLevel lattice_level(const BlockPattern& pattern, std::span<const Point> positions,
                           std::span<const Index> at_rest, const Lattice& lattice) {
  std::vector<Hold> holds;
  holds.reserve(4 * positions.size());
  for (std::size_t node = 0; node < positions.size(); ++node) {
    if (!at_rest.empty() && at_rest.front() == Index(node))
      at_rest = at_rest.subspan(1);
    else
      append_holds(positions[node], Index(node), lattice, holds);
  }
  std::ranges::stable_sort(holds, {}, &Hold::corner);
  LatticeLevel level;
  std::vector<Entry> entries;
  entries.reserve(holds.size());
  Parts parts(pattern);
  for (auto begin = holds.begin(); begin != holds.end();) {
    const auto end = std::find_if(begin, holds.end(),
                                  [&](const Hold& hold) { return hold.corner != begin->corner; });
    const Index count =
        parts.number({begin, end}, Index(level.positions.size()), [&](const Hold& hold, Index part) {
          entries.push_back({hold.node, part, hold.weight});
        });
    Point point;
    for (std::size_t k = 0; k < 3; ++k)
      point[k] = lattice.origin[k] + lattice.spacing * begin->corner[k];
    level.positions.resize(at(count), point);
    begin = end;
  }
  level.prolongation =
      from_entries(std::move(entries), Index(positions.size()), Index(level.positions.size()));
  return level;
}

}  // namespace souple
