// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "runtime/compliance/rest_compliance.hpp"

namespace souple::test {

/// A hierarchical compliance from random bytes: any bytes decode to some symmetric matrix.
struct RandomRecords {
  ComplianceHeader header;
  HierarchicalIndex index;
  std::vector<std::byte> payload;

  using Opened = Result<std::unique_ptr<const RestCompliance>>;
  Opened open(std::size_t table_bytes = 0) const {
    return open_rest_compliance(
        header, index, std::make_unique<MemoryBlockSource>(payload, index.record_begin), table_bytes);
  }

  RandomRecords(Index nodes, int depth, Index rank) {
    header.representation = ComplianceRepresentation::hierarchical;
    header.node_count = nodes;
    header.shift = 0.25;
    std::mt19937 random(7);
    index.depth = depth;
    index.order.resize(std::size_t(nodes));
    std::iota(index.order.begin(), index.order.end(), Index{0});
    std::ranges::shuffle(index.order, random);
    index.scale.assign(std::size_t(nodes), {1.5F, 0.25F, 1, -0.5F, 0.125F, 2});
    const std::size_t leaves = std::size_t{1} << depth;
    index.leaf_planes.assign(leaves, 4);
    index.rank.assign(leaves - 1, rank);
    index.step.assign(leaves - 1, 1e-4F);
    index.singular.assign((leaves - 1) * std::size_t(rank), 0.5F);
    index.planes.assign(index.singular.size(), 4);
    index.leaf_step.assign(leaves, 1e-5F);
    index.record_begin = {0};
    for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
      for (int k = 0; k < 400; ++k) payload.push_back(std::byte(random() % 256));
      index.record_begin.push_back(std::int64_t(payload.size()));
    }
  }
};

}  // namespace souple::test
