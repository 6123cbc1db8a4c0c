// SPDX-License-Identifier: MIT
#include "runtime/compliance/hierarchical_compliance.hpp"

#include <algorithm>

#include "runtime/compliance/block_gather.hpp"
#include "runtime/compliance/block_scatter.hpp"

namespace souple {

bool HierarchicalCompliance::ready(std::span<const Index> rows) const {
  bool all = true;
  for (const Index row : rows)
    all = records_->make_ready(records_->leaf_of(records_->position_of(row))) && all;
  return all;
}

bool HierarchicalCompliance::ready_to_apply(std::span<const Index> rows) const {
  if (rows.empty()) return true;
  bool all = true;
  for (Index leaf = 0; leaf < records_->leaf_count(); ++leaf) all = records_->make_ready(leaf) && all;
  return all;
}

void HierarchicalCompliance::gather(std::span<const Index> rows, std::span<double> out) const {
  ComplianceWork work;
  const std::size_t size = 3 * rows.size();
  std::vector<float> block(size * size);
  gather_block(rows, rows, block.data(), size, work);
  std::ranges::copy(block, out.begin());
}

void HierarchicalCompliance::gather_block(std::span<const Index> rows, std::span<const Index> columns,
                                          float* out, std::size_t stride, ComplianceWork& work) const {
  if (table_)
    table_->read_block(sort_rows(*records_, rows, work.sorted_rows),
                       sort_rows(*records_, columns, work.sorted_columns), out, stride);
  else
    BlockGather(*records_, work, out, stride).run(rows, columns);
}

void HierarchicalCompliance::gather_lower(std::span<const Index> rows, float* out, std::size_t stride,
                                          ComplianceWork& work) const {
  if (table_)
    table_->read_lower(sort_rows(*records_, rows, work.sorted_rows), out, stride);
  else
    RestCompliance::gather_lower(rows, out, stride, work);
}

void HierarchicalCompliance::apply(std::span<const Index> rows, std::span<const double> force,
                                   std::span<double> displacement, ComplianceWork& work) const {
  BlockScatter(*records_, work, displacement).run(rows, force);
}

}  // namespace souple
