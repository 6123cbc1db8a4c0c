// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// The numbers that a file gives its nodes, in any order and with gaps, to 0-based indices.
class NodeTags {
 public:
  void reserve(std::size_t count) { tags_.reserve(count); }
  /// The next node.
  void add(std::int64_t tag);
  /// Call once all are added; false if two nodes have the same tag.
  bool finish();
  /// -1: no node has it.
  Index find(std::int64_t tag) const;

 private:
  std::vector<std::pair<std::int64_t, Index>> tags_;
  bool consecutive_ = true;  ///< ascending by one: the usual file needs no search
};

}  // namespace souple
