// SPDX-License-Identifier: MIT
#include "runtime/contact/delassus_block.hpp"

#include <algorithm>

namespace souple {

void DelassusBlock::resize(std::size_t contact_count) {
  columns_.reset(3 * contact_count, 3 * contact_count);
  base_.assign(columns_.stride(), 0.0);
  increment_.assign(columns_.stride() + PaddedColumns::pack - 1, 0.0F);
  offset_ = aligned_offset(increment_);
}

void DelassusBlock::clear_gap() {
  std::ranges::fill(base_, 0.0);
  std::ranges::fill(increment_, 0.0F);
}

}  // namespace souple
