// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/geometry/box_tree.hpp"

#include <algorithm>
#include <numeric>

#include "tools/geometry/vector.hpp"

namespace souple {
namespace {

constexpr std::size_t leaf_size = 4;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Box united(std::span<const Index> range, std::span<const Box> boxes, double room) {
  Box whole = boxes[at(range[0])];
  for (const Index i : range)
    for (std::size_t k = 0; k < 3; ++k) {
      whole.low[k] = std::min(whole.low[k], boxes[at(i)].low[k]);
      whole.high[k] = std::max(whole.high[k], boxes[at(i)].high[k]);
    }
  for (std::size_t k = 0; k < 3; ++k) {
    const double more = room * (whole.high[k] - whole.low[k]);
    whole.low[k] -= more;
    whole.high[k] += more;
  }
  return whole;
}

}  // namespace

BoxTree::BoxTree(std::span<const Box> boxes, const std::vector<Point>& centres, double room)
    : order_(boxes.size()) {
  std::iota(order_.begin(), order_.end(), Index{0});
  if (!order_.empty()) build(order_, 0, boxes, centres, room);
}

Index BoxTree::build(std::span<Index> range, std::size_t offset, std::span<const Box> boxes,
                     const std::vector<Point>& centres, double room) {
  const auto self = static_cast<Index>(nodes_.size());
  const Box box = united(range, boxes, room);
  nodes_.push_back({box});
  if (range.size() <= leaf_size) {
    nodes_.back().first = static_cast<Index>(offset);
    nodes_.back().count = static_cast<Index>(range.size());
    return self;
  }
  const Point side = subtract(box.high, box.low);
  const auto axis = static_cast<std::size_t>(std::ranges::max_element(side) - side.begin());
  const std::size_t half = range.size() / 2;
  std::ranges::nth_element(range, range.begin() + static_cast<std::ptrdiff_t>(half),
                           [&](Index a, Index b) {
                             const double ca = centres[at(a)][axis], cb = centres[at(b)][axis];
                             return ca != cb ? ca < cb : a < b;
                           });
  build(range.first(half), offset, boxes, centres, room);
  const Index right = build(range.subspan(half), offset + half, boxes, centres, room);
  nodes_[at(self)].first = right;
  return self;
}

}  // namespace souple
