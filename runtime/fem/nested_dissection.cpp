// SPDX-License-Identifier: MIT
#include "runtime/fem/nested_dissection.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace souple {
namespace {

// Where the median is not the best place to cut: shares of the nodes on the left.
constexpr std::array<double, 5> cut_shares{0.4, 0.45, 0.5, 0.55, 0.6};

enum Side : std::int8_t { outside = -1, left = 0, right = 1, separator = 2 };

// Pieces of one set of nodes; recursion depth is the logarithm of the node count.
class Dissection {
 public:
  Dissection(const BlockPattern& pattern, std::span<const Point> positions, Index leaf_nodes)
      : pattern_(pattern),
        positions_(positions),
        leaf_nodes_(leaf_nodes),
        side_(std::size_t(pattern.node_count()), outside),
        mate_(side_.size(), -1),
        seen_(side_.size(), -1) {}

  // Returns the root of the part, -1 if it is empty.
  Index dissect(std::vector<Index> part) {
    if (part.empty()) return -1;
    if (Index(part.size()) <= leaf_nodes_) return add_piece(std::move(part), {-1, -1});
    std::vector<Index> best;
    std::vector<std::int8_t> best_side;
    double best_cost = 0;
    for (const int axis : {0, 1, 2}) {
      sort_along(part, axis);
      for (const double share : cut_shares) {
        const double cost = cut(part, share);
        if (!best.empty() && cost >= best_cost) continue;
        best_cost = cost;
        best = part;
        best_side.clear();
        for (const Index node : part) best_side.push_back(side_[std::size_t(node)]);
      }
    }
    for (const Index node : part) side_[std::size_t(node)] = outside;
    std::vector<Index> halves[2], middle;
    for (std::size_t k = 0; k < best.size(); ++k)
      (best_side[k] == separator ? middle : halves[best_side[k]]).push_back(best[k]);
    const std::array<Index, 2> children{dissect(std::move(halves[0])), dissect(std::move(halves[1]))};
    if (!middle.empty()) return add_piece(std::move(middle), children);
    // Parts that do not couple: the second root stands in for both.
    if (children[0] >= 0 && children[1] >= 0) tree_.parent[std::size_t(children[0])] = children[1];
    return children[1] >= 0 ? children[1] : children[0];
  }

  EliminationTree take() { return std::move(tree_); }

 private:
  Index add_piece(std::vector<Index> nodes, const std::array<Index, 2>& children) {
    const Index piece = tree_.piece_count();
    if (tree_.begin.empty()) tree_.begin.push_back(0);
    std::ranges::sort(nodes);
    tree_.order.insert(tree_.order.end(), nodes.begin(), nodes.end());
    tree_.begin.push_back(static_cast<Index>(tree_.order.size()));
    tree_.parent.push_back(-1);
    for (const Index child : children)
      if (child >= 0) tree_.parent[std::size_t(child)] = piece;
    return piece;
  }

  void sort_along(std::vector<Index>& part, int axis) const {
    const auto key = [&](Index node) { return positions_[std::size_t(node)][std::size_t(axis)]; };
    std::ranges::sort(part,
                      [&](Index a, Index b) { return key(a) < key(b) || (key(a) == key(b) && a < b); });
  }

  // Marks the sides of a sorted part; the size of the separator, larger for unequal halves.
  double cut(const std::vector<Index>& part, double share) {
    const auto middle = std::max<std::size_t>(1, std::size_t(share * double(part.size())));
    for (std::size_t k = 0; k < part.size(); ++k) {
      side_[std::size_t(part[k])] = k < middle ? left : right;
      mate_[std::size_t(part[k])] = -1;
      seen_[std::size_t(part[k])] = -1;
    }
    const std::size_t cover = cover_cut(part, middle);
    const double l = double(middle), r = double(part.size() - middle);
    const double imbalance = std::abs(l - r) / (l + r);
    return double(cover) * (1 + 0.5 * imbalance);
  }

  template <class Visit>
  void across(Index node, Visit&& visit) const {
    for (Index b = pattern_.row_begin[std::size_t(node)]; b < pattern_.row_begin[std::size_t(node) + 1];
         ++b)
      if (side_[std::size_t(pattern_.column[std::size_t(b)])] == right)
        if (visit(pattern_.column[std::size_t(b)])) return;
  }

  // One augmenting path of the matching between the two sides of the cut.
  bool augment(Index node, Index stamp) {
    bool found = false;
    across(node, [&](Index other) {
      if (seen_[std::size_t(other)] == stamp) return false;
      seen_[std::size_t(other)] = stamp;
      const Index mate = mate_[std::size_t(other)];
      if (mate >= 0 && !augment(mate, stamp)) return false;
      mate_[std::size_t(other)] = node;
      mate_[std::size_t(node)] = other;
      return found = true;
    });
    return found;
  }

  void reach(Index node) {
    reached_.push_back(node);
    across(node, [&](Index other) {
      if (seen_[std::size_t(other)] == reached_stamp) return false;
      seen_[std::size_t(other)] = reached_stamp;
      if (mate_[std::size_t(other)] >= 0) reach(mate_[std::size_t(other)]);
      return false;
    });
  }

  // König: a largest matching gives a smallest cover. It becomes the separator.
  std::size_t cover_cut(const std::vector<Index>& part, std::size_t middle) {
    border_.clear();
    for (std::size_t k = 0; k < middle; ++k) {
      bool touches = false;
      across(part[k], [&](Index) { return touches = true; });
      if (touches) border_.push_back(part[k]);
    }
    for (const Index node : border_) augment(node, node);
    reached_.clear();
    for (const Index node : border_)
      if (mate_[std::size_t(node)] < 0) reach(node);
    std::size_t cover = 0;
    for (const Index node : border_) {
      const Index mate = mate_[std::size_t(node)];
      if (mate < 0) continue;
      const bool by_mate = seen_[std::size_t(mate)] == reached_stamp;
      side_[std::size_t(by_mate ? mate : node)] = separator;
      ++cover;
    }
    return cover;
  }

  static constexpr Index reached_stamp = -2;

  const BlockPattern& pattern_;
  std::span<const Point> positions_;
  Index leaf_nodes_;
  EliminationTree tree_;
  std::vector<std::int8_t> side_;
  std::vector<Index> mate_, seen_;  ///< of the matching across a cut
  std::vector<Index> border_, reached_;
};

}  // namespace

EliminationTree nested_dissection(const BlockPattern& pattern, std::span<const Point> positions,
                                  std::span<const Index> nodes, Index leaf_nodes) {
  Dissection dissection(pattern, positions, leaf_nodes);
  dissection.dissect({nodes.begin(), nodes.end()});
  return dissection.take();
}

}  // namespace souple
