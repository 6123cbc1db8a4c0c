// SPDX-License-Identifier: MIT
#include "runtime/fem/front_plan.hpp"

#include <algorithm>

namespace souple {
namespace {

constexpr Index leaf_nodes = 12;  // below, dense columns cost less than more pieces

class FrontPlanner {
 public:
  FrontPlanner(const BlockPattern& pattern, EliminationTree tree)
      : pattern_(pattern),
        tree_(std::move(tree)),
        place_(std::size_t(pattern.node_count()), -1),
        local_(tree_.order.size(), -1),
        children_(tree_.parent.size()) {
    for (std::size_t k = 0; k < tree_.order.size(); ++k) place_[std::size_t(tree_.order[k])] = Index(k);
    for (std::size_t piece = tree_.parent.size(); piece-- > 0;)
      if (tree_.parent[piece] >= 0) children_[std::size_t(tree_.parent[piece])].push_back(Index(piece));
  }

  FrontPlan make() {
    for (std::size_t piece = 0; piece < children_.size(); ++piece) add_front(piece);
    plan_.order = std::move(tree_.order);
    return std::move(plan_);
  }

 private:
  // Blocks of a place's row whose other node is eliminated with or after the piece.
  template <class Visit>
  void for_later(Index place, Index begin, Visit&& visit) const {
    const auto node = std::size_t(tree_.order[std::size_t(place)]);
    for (Index b = pattern_.row_begin[node]; b < pattern_.row_begin[node + 1]; ++b) {
      const Index other = place_[std::size_t(pattern_.column[std::size_t(b)])];
      if (other >= begin) visit(other, b);
    }
  }

  void add_front(std::size_t piece) {
    FrontPlan::Front front;
    front.begin = tree_.begin[piece];
    front.end = tree_.begin[piece + 1];
    front.subtree_begin = front.begin;
    for (const Index child : children_[piece])
      front.subtree_begin =
          std::min(front.subtree_begin, plan_.fronts[std::size_t(child)].subtree_begin);
    front.border_begin = plan_.border.size();
    collect_border(piece, front);
    front.border_end = plan_.border.size();
    number_places(front);
    front.entry_begin = plan_.entries.size();
    for (Index k = front.begin; k < front.end; ++k)
      for_later(k, k, [&](Index other, Index block) {
        plan_.entries.push_back({block, local_[std::size_t(other)], k - front.begin});
      });
    front.entry_end = plan_.entries.size();
    front.child_begin = plan_.children.size();
    for (const Index child : children_[piece]) adopt(child);
    front.child_end = plan_.children.size();
    front.panel_begin = plan_.panel_scalars;
    plan_.panel_scalars += 9 * front.size() * front.own();
    open_scalars_ += 9 * front.border() * front.border();
    plan_.stack_scalars = std::max(plan_.stack_scalars, open_scalars_);
    plan_.update_scalars = std::max(plan_.update_scalars, 9 * front.border() * front.border());
    forget_places(front);
    plan_.fronts.push_back(front);
  }

  void collect_border(std::size_t piece, const FrontPlan::Front& front) {
    const auto add = [&](Index place) {
      if (place < front.end || local_[std::size_t(place)] >= 0) return;
      local_[std::size_t(place)] = 0;
      plan_.border.push_back(place);
    };
    for (Index k = front.begin; k < front.end; ++k)
      for_later(k, front.begin, [&](Index other, Index) { add(other); });
    for (const Index child : children_[piece]) {
      const FrontPlan::Front& below = plan_.fronts[std::size_t(child)];
      for (std::size_t k = below.border_begin; k < below.border_end; ++k) add(plan_.border[k]);
    }
    std::sort(plan_.border.begin() + std::ptrdiff_t(front.border_begin), plan_.border.end());
  }

  void number_places(const FrontPlan::Front& front) {
    for (Index k = front.begin; k < front.end; ++k) local_[std::size_t(k)] = k - front.begin;
    for (std::size_t k = front.border_begin; k < front.border_end; ++k)
      local_[std::size_t(plan_.border[k])] = Index(front.own() + k - front.border_begin);
  }

  void forget_places(const FrontPlan::Front& front) {
    for (Index k = front.begin; k < front.end; ++k) local_[std::size_t(k)] = -1;
    for (std::size_t k = front.border_begin; k < front.border_end; ++k)
      local_[std::size_t(plan_.border[k])] = -1;
  }

  void adopt(Index child) {
    FrontPlan::Front& below = plan_.fronts[std::size_t(child)];
    plan_.children.push_back(child);
    below.map_begin = plan_.map.size();
    for (std::size_t k = below.border_begin; k < below.border_end; ++k)
      plan_.map.push_back(local_[std::size_t(plan_.border[k])]);
    open_scalars_ -= 9 * below.border() * below.border();
  }

  const BlockPattern& pattern_;
  EliminationTree tree_;
  std::vector<Index> place_;  ///< in the order, by node; -1: not in the part
  std::vector<Index> local_;  ///< in the front, by place
  std::vector<std::vector<Index>> children_;
  std::size_t open_scalars_ = 0;
  FrontPlan plan_;
};

}  // namespace

FrontPlan make_front_plan(const BlockPattern& pattern, std::span<const Point> positions,
                          std::span<const Index> nodes) {
  return FrontPlanner(pattern, nested_dissection(pattern, positions, nodes, leaf_nodes)).make();
}

}  // namespace souple
