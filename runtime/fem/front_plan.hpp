// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "runtime/fem/nested_dissection.hpp"

namespace souple {

/// Where every number of a multifrontal elimination goes, so that replaying it searches and allocates
/// nothing. A front holds a piece's own nodes and its border: the later nodes that it couples to.
struct FrontPlan {
  struct Entry {
    Index block;        ///< of the matrix; to be transposed, as it is read from the row of the column
    Index row, column;  ///< in the front, nodes; row >= column
  };
  struct Front {
    Index begin = 0, end = 0;                      ///< own nodes in the order
    Index subtree_begin = 0;                       ///< up to `end`: its own and its descendants' nodes
    std::size_t border_begin = 0, border_end = 0;  ///< in `border`
    std::size_t entry_begin = 0, entry_end = 0;    ///< in `entries`
    std::size_t child_begin = 0, child_end = 0;    ///< in `children`
    std::size_t map_begin = 0;    ///< in `map`: place of every border node in the parent's front
    std::size_t panel_begin = 0;  ///< of its own columns among all panels, scalars

    std::size_t own() const { return std::size_t(end - begin); }
    std::size_t border() const { return border_end - border_begin; }
    std::size_t size() const { return own() + border(); }
  };

  std::vector<Index> order;  ///< the nodes as they are eliminated
  std::vector<Front>
      fronts;  ///< children before parents; a parent's children are the last that are open
  std::vector<Index> border;  ///< places in the order, ascending in each front
  std::vector<Entry> entries;
  std::vector<Index> children;  ///< fronts, last first
  std::vector<Index> map;
  std::size_t panel_scalars = 0;   ///< of all panels
  std::size_t stack_scalars = 0;   ///< most that open updates hold at once
  std::size_t update_scalars = 0;  ///< of the largest update
};

FrontPlan make_front_plan(const BlockPattern& pattern, std::span<const Point> positions,
                          std::span<const Index> nodes);

}  // namespace souple
