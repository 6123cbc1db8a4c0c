// SPDX-License-Identifier: GPL-3.0-or-later
// Walks over the elimination tree of a supernodal factor from the leaves to the roots, on several
// threads, with results that do not depend on their number.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tools/compliance/supernodal_factor.hpp"
#include "tools/compliance/worker_pool.hpp"

namespace souple {

struct SupernodeTree {
  std::vector<std::int64_t> parent;                 ///< -1: a root
  std::vector<std::vector<std::int64_t>> children;  ///< ascending
  std::vector<std::int64_t> first_descendant;       ///< subtree of s: [first_descendant[s], s]

  std::size_t count() const { return parent.size(); }
};
SupernodeTree build_tree(const SupernodeView& view);

/// Where the rows below child `child` stand among the rows of its parent `s`.
std::vector<std::int64_t> rows_in_parent(const SupernodeView& view, std::size_t child, std::size_t s);

/// Runs `count` independent pieces of one supernode's work.
using Pieces = std::function<void(std::size_t count, const std::function<void(std::size_t)>& piece)>;

/// The work on supernode s, its children being done. `worker` names scratch memory that nobody else
/// uses meanwhile; pieces may run on any thread.
using SupernodeWork = std::function<void(std::size_t s, unsigned worker, const Pieces& pieces)>;

struct TreeWalk {
  std::vector<double> cost;                       ///< of every supernode, any unit
  std::function<void(double fraction)> progress;  ///< may be empty; called from the calling thread
  std::function<bool()> cancelled;                ///< may be empty; the same
};

/// Subtrees below a share of the whole cost run whole on one thread each; the supernodes above them one
/// after another, their pieces on all threads. The division depends on the costs alone. False:
/// cancelled.
bool walk_tree(const SupernodeTree& tree, WorkerPool& pool, const TreeWalk& walk,
               const SupernodeWork& work);

/// Most that is held at once during the walk: every supernode holds `while_working[s]` while it is
/// worked on, its children's `kept` until then, and `kept[s]` from then on until its parent is done.
/// The same for any number of threads up to `threads`.
double peak_of_walk(const SupernodeTree& tree, const std::vector<double>& cost, unsigned threads,
                    const std::vector<double>& while_working, const std::vector<double>& kept);

}  // namespace souple
