// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/node_tags.hpp"

#include <algorithm>

namespace souple {

void NodeTags::add(std::int64_t tag) {
  // The first comparison keeps the sum of the second from overflowing.
  if (!tags_.empty() && (tag <= tags_.back().first || tags_.back().first + 1 != tag))
    consecutive_ = false;
  tags_.emplace_back(tag, static_cast<Index>(tags_.size()));
}

bool NodeTags::finish() {
  if (consecutive_) return true;
  std::ranges::sort(tags_);
  return std::ranges::adjacent_find(tags_, {}, &std::pair<std::int64_t, Index>::first) == tags_.end();
}

Index NodeTags::find(std::int64_t tag) const {
  if (tags_.empty() || tag < tags_.front().first || tag > tags_.back().first) return -1;
  if (consecutive_) return static_cast<Index>(tag - tags_.front().first);
  const auto found = std::ranges::lower_bound(tags_, tag, {}, &std::pair<std::int64_t, Index>::first);
  return found->first == tag ? found->second : -1;
}

}  // namespace souple
