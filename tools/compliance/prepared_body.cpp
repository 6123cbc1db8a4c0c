// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/prepared_body.hpp"

#include <algorithm>

#include "tools/compliance/node_ordering.hpp"

namespace souple {

Result<const CorotationalModel*> PreparedBody::model() {
  if (!model_) {
    auto made = CorotationalModel::create(level_.mesh, material_);
    if (!made) return made.issue();
    model_ = std::move(*made);
  }
  return &*model_;
}

Result<std::span<const Index>> PreparedBody::order(std::span<const Index> free_nodes,
                                                   std::span<const Index> surface) {
  for (const auto& known : orders_)
    if (std::ranges::equal(known->free_nodes, free_nodes) &&
        std::ranges::equal(known->surface, surface))
      return std::span<const Index>(known->order);
  auto order = order_nodes(model_->pattern(), free_nodes, surface);
  if (!order) return order.issue();
  orders_.push_back(std::make_unique<const Order>(Order{
      {free_nodes.begin(), free_nodes.end()}, {surface.begin(), surface.end()}, std::move(*order)}));
  return std::span<const Index>(orders_.back()->order);
}

}  // namespace souple
