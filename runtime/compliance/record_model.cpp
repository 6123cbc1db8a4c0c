// SPDX-License-Identifier: MIT
#include "runtime/compliance/record_model.hpp"

namespace souple {

std::vector<RecordShape> record_shapes(const HierarchicalIndex& index, Index node_count) {
  std::vector<std::size_t> first{0};
  for (const Index rank : index.rank) first.push_back(first.back() + std::size_t(rank));
  const auto depth = int(index.depth);
  std::vector<RecordShape> shapes(std::size_t{1} << depth);
  for (Index leaf = 0; leaf < Index(shapes.size()); ++leaf) {
    RecordShape& shape = shapes[std::size_t(leaf)];
    shape.leaf = leaf;
    shape.rows = 3 * cluster_range(node_count, depth, leaf).size();
    for (int d = 0; d < depth; ++d) {
      const auto block = std::size_t(block_of_cluster(d, leaf >> (depth - d)));
      const Index side = cluster_range(node_count, d + 1, leaf >> (depth - d - 1)).size();
      shape.factors.push_back({block, first[block], index.rank[block], 3 * std::int64_t{side}});
    }
  }
  return shapes;
}

}  // namespace souple
