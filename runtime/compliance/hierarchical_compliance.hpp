// SPDX-License-Identifier: MIT
#pragma once
#include <memory>

#include "runtime/compliance/decoded_records.hpp"
#include "runtime/compliance/pair_table.hpp"
#include "runtime/compliance/rest_compliance.hpp"

namespace souple {

/// C0 from hierarchical low-rank blocks, in single precision. What a call costs goes with the terms of
/// the blocks that its rows share, not with the size of the body; apply moves all rows and reads all
/// records that the force reaches.
class HierarchicalCompliance final : public RestCompliance {
 public:
  /// Without a table blocks are evaluated from the factors.
  explicit HierarchicalCompliance(std::unique_ptr<const DecodedRecords> records,
                                  std::unique_ptr<const PairTable> table = {})
      : records_(std::move(records)), table_(std::move(table)) {}

  Index row_count() const override { return records_->node_count(); }
  bool ready(std::span<const Index> rows) const override;
  bool ready_to_apply(std::span<const Index> rows) const override;
  /// Allocates its scratch memory; the other evaluations do not once `work` has grown.
  void gather(std::span<const Index> rows, std::span<double> out) const override;
  void gather_block(std::span<const Index> rows, std::span<const Index> columns, float* out,
                    std::size_t stride, ComplianceWork& work) const override;
  void gather_lower(std::span<const Index> rows, float* out, std::size_t stride,
                    ComplianceWork& work) const override;
  Index order_of(Index row) const override { return records_->position_of(row); }
  bool gathers_at_once() const override { return table_ != nullptr; }
  /// Rows whose record is not there (ready_to_apply) get the displacement zero.
  void apply(std::span<const Index> rows, std::span<const double> force, std::span<double> displacement,
             ComplianceWork& work) const override;
  std::size_t resident_bytes() const override { return records_->resident_bytes() + table_bytes(); }
  std::size_t table_bytes() const override { return table_ ? table_->bytes() : 0; }

 private:
  std::unique_ptr<const DecodedRecords> records_;
  std::unique_ptr<const PairTable> table_;
};

}  // namespace souple
