// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/supernode_tree.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace souple {
namespace {

// A subtree of more than this share of the whole cost is worth all threads, front by front. The fewer
// the subtrees, the longer the last one runs alone; the more, the more loops wait for their last piece.
constexpr double largest_subtree_share = 1.0 / 24;

struct Division {
  std::vector<std::size_t> subtrees;  ///< their roots, costly ones first
  std::vector<std::size_t> above;     ///< ascending
};

Division divide(const SupernodeTree& tree, const std::vector<double>& cost) {
  std::vector<double> total = cost;
  for (std::size_t s = 0; s < tree.count(); ++s)
    if (tree.parent[s] >= 0) total[std::size_t(tree.parent[s])] += total[s];
  double whole = 0;
  std::vector<std::size_t> open;
  for (std::size_t s = 0; s < tree.count(); ++s)
    if (tree.parent[s] < 0) {
      whole += total[s];
      open.push_back(s);
    }
  Division division;
  while (!open.empty()) {
    const std::size_t s = open.back();
    open.pop_back();
    if (total[s] <= largest_subtree_share * whole) {
      division.subtrees.push_back(s);
      continue;
    }
    division.above.push_back(s);
    for (const std::int64_t child : tree.children[s]) open.push_back(std::size_t(child));
  }
  std::ranges::sort(division.above);
  std::ranges::sort(division.subtrees, [&](std::size_t a, std::size_t b) {
    return total[a] != total[b] ? total[a] > total[b] : a < b;
  });
  return division;
}

/// Counts the cost that is done, and asks whether to go on.
class Watch {
 public:
  explicit Watch(const TreeWalk& walk)
      : walk_(walk), whole_(std::accumulate(walk.cost.begin(), walk.cost.end(), 0.0)) {}

  bool stopped(unsigned worker) {
    if (worker == 0 && walk_.cancelled && !stopped_ && walk_.cancelled()) stopped_ = true;
    return stopped_;
  }
  void add(double cost, unsigned worker) {
    done_ += cost;
    if (worker == 0 && walk_.progress) walk_.progress(whole_ > 0 ? std::min(1.0, done_ / whole_) : 1.0);
  }

 private:
  const TreeWalk& walk_;
  double whole_;
  std::atomic<double> done_{0};
  std::atomic<bool> stopped_{false};
};

}  // namespace

SupernodeTree build_tree(const SupernodeView& view) {
  const std::size_t count = view.count();
  std::vector<std::int64_t> owner(std::size_t(view.first_column[count]));
  for (std::size_t s = 0; s < count; ++s)
    std::fill(owner.begin() + view.first_column[s], owner.begin() + view.first_column[s + 1],
              std::int64_t(s));
  SupernodeTree tree;
  tree.parent.assign(count, -1);
  tree.children.resize(count);
  tree.first_descendant.resize(count);
  std::iota(tree.first_descendant.begin(), tree.first_descendant.end(), 0);
  for (std::size_t s = 0; s < count; ++s) {
    const auto below = view.below(s);
    if (below.empty()) continue;
    const std::int64_t parent = tree.parent[s] = owner[std::size_t(below[0])];
    tree.children[std::size_t(parent)].push_back(std::int64_t(s));
    std::int64_t& first = tree.first_descendant[std::size_t(parent)];
    first = std::min(first, tree.first_descendant[s]);
  }
  return tree;
}

std::vector<std::int64_t> rows_in_parent(const SupernodeView& view, std::size_t child, std::size_t s) {
  const auto below = view.below(child);
  const auto rows = view.row.subspan(std::size_t(view.row_begin[s]), std::size_t(view.rows(s)));
  std::vector<std::int64_t> places(below.size());
  std::size_t at = 0;  // both ascend, and all rows of the child are among the parent's
  for (std::size_t k = 0; k < below.size(); ++k) {
    while (rows[at] != below[k]) ++at;
    places[k] = std::int64_t(at);
  }
  return places;
}

bool walk_tree(const SupernodeTree& tree, WorkerPool& pool, const TreeWalk& walk,
               const SupernodeWork& work) {
  const Division division = divide(tree, walk.cost);
  Watch watch(walk);
  const Pieces one_after_another = [](std::size_t count,
                                      const std::function<void(std::size_t)>& piece) {
    for (std::size_t k = 0; k < count; ++k) piece(k);
  };
  pool.run(division.subtrees.size(), [&](std::size_t item, unsigned worker) {
    const std::size_t root = division.subtrees[item];
    for (auto s = std::size_t(tree.first_descendant[root]); s <= root; ++s) {
      if (watch.stopped(worker)) return;
      work(s, worker, one_after_another);
      watch.add(walk.cost[s], worker);
    }
  });
  const Pieces on_all_threads = [&](std::size_t count, const std::function<void(std::size_t)>& piece) {
    pool.run(count, [&](std::size_t k, unsigned worker) {
      if (!watch.stopped(worker)) piece(k);
    });
  };
  for (const std::size_t s : division.above) {
    if (watch.stopped(0)) return false;
    work(s, 0, on_all_threads);
    watch.add(walk.cost[s], 0);
  }
  return !watch.stopped(0);
}

double peak_of_walk(const SupernodeTree& tree, const std::vector<double>& cost, unsigned threads,
                    const std::vector<double>& while_working, const std::vector<double>& kept) {
  const Division division = divide(tree, cost);
  double held = 0, peak = 0;
  const auto visit = [&](std::size_t s) {
    peak = std::max(peak, held + while_working[s]);
    for (const std::int64_t child : tree.children[s]) held -= kept[std::size_t(child)];
    held += kept[s];
  };
  std::vector<double> subtree_peaks;
  double kept_by_subtrees = 0;
  for (const std::size_t root : division.subtrees) {
    held = peak = 0;
    for (auto s = std::size_t(tree.first_descendant[root]); s <= root; ++s) visit(s);
    subtree_peaks.push_back(peak);
    kept_by_subtrees += kept[root];
  }
  std::ranges::sort(subtree_peaks, std::greater());
  double largest = kept_by_subtrees;
  for (std::size_t k = 0; k < std::min<std::size_t>(threads, subtree_peaks.size()); ++k)
    largest += subtree_peaks[k];
  held = kept_by_subtrees;
  peak = 0;
  for (const std::size_t s : division.above) visit(s);
  return std::max(largest, peak);
}

}  // namespace souple
