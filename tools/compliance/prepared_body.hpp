// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "runtime/fem/corotational_model.hpp"

namespace souple {

/// What the compliances of one body share, each made when it is first asked for: the elements, and the
/// orders in which nodes are eliminated. Not for several threads at once.
class PreparedBody {
 public:
  /// Both must outlive it. `level` is the finest one.
  PreparedBody(const MeshLevel& level, const Material& material) : level_(level), material_(material) {}

  const MeshLevel& level() const { return level_; }
  const Material& material() const { return material_; }
  /// Issues: mesh_element_invalid, material_out_of_range.
  Result<const CorotationalModel*> model();
  /// order_nodes of the model's pattern, which must be there; valid as long as the body.
  Result<std::span<const Index>> order(std::span<const Index> free_nodes,
                                       std::span<const Index> surface);

 private:
  struct Order {
    std::vector<Index> free_nodes, surface, order;
  };

  const MeshLevel& level_;
  const Material& material_;
  std::optional<CorotationalModel> model_;
  std::vector<std::unique_ptr<const Order>> orders_;
};

}  // namespace souple
