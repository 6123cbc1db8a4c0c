// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "runtime/compliance/block_source.hpp"
#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// Scratch memory of an evaluation, one per thread and body: nothing is allocated once it has grown.
struct ComplianceWork {
  std::vector<float> a, b, c;  ///< grow to what is needed and stay so
  std::vector<std::uint64_t> sorted_rows, sorted_columns;
  std::vector<std::size_t> row_panels, column_panels;
  // Of a ProlongedCompliance around the representation that uses the above.
  std::vector<Index> coarse_rows, coarse_columns;
  std::vector<float> coarse_block, half_block;
  std::vector<double> coarse_force, coarse_motion;
};

/// The rest compliance C0 on the n nodes of a variant: symmetric positive definite, 3n x 3n, m/N, rest
/// frame. `row` counts these nodes, 0 <= row < n. Representations (dense now, compressed ones later)
/// differ only behind this interface. Const and shared; evaluation allocates nothing.
class RestCompliance {
 public:
  virtual ~RestCompliance() = default;
  virtual Index row_count() const = 0;
  /// Whether every block that gathering these rows needs is in memory; asks for what is missing.
  virtual bool ready(std::span<const Index> rows) const = 0;
  /// The same for apply, which moves all rows: a hierarchical compliance needs all its blocks.
  virtual bool ready_to_apply(std::span<const Index> rows) const { return ready(rows); }
  /// out = C0 on rows x rows, dense, row-major, (3m) x (3m) with leading dimension 3m.
  virtual void gather(std::span<const Index> rows, std::span<double> out) const = 0;
  /// out, 3 |rows| x 3 |columns|, row-major with leading dimension `stride`: C0(rows, columns). The
  /// bits of a block depend on its pair of nodes alone, not on what else is asked for, and C_ij =
  /// C_ji^T to the bit: what was evaluated for one step can be kept for the next.
  virtual void gather_block(std::span<const Index> rows, std::span<const Index> columns, float* out,
                            std::size_t stride, ComplianceWork& work) const = 0;
  /// The same for rows x rows, but only blocks (a, b) with b <= a are to be relied on; others may be
  /// overwritten up to column 3 |rows|. `rows` ascend by order_of, each once.
  virtual void gather_lower(std::span<const Index> rows, float* out, std::size_t stride,
                            ComplianceWork& work) const;
  /// Where a row stands in the order in which rows are gathered fastest: a bijection of [0, n).
  virtual Index order_of(Index row) const { return row; }
  /// Whether gather_lower costs no more than copying what it gives.
  virtual bool gathers_at_once() const { return false; }
  /// displacement = C0(:, rows) force: `force` holds 3 values per row, `displacement` 3n.
  virtual void apply(std::span<const Index> rows, std::span<const double> force,
                     std::span<double> displacement, ComplianceWork& work) const = 0;
  virtual std::size_t resident_bytes() const = 0;
  /// Of these, what serves to gather faster (PairTable).
  virtual std::size_t table_bytes() const { return 0; }
};

/// Opens the representation that the header names. Issues: unsupported_feature, asset_corrupt (sizes).
/// `hierarchy` matters to the hierarchical one only; block i of `source` is the record of leaf i there.
/// It gets a PairTable if that needs no more than `table_bytes` and all records are in memory.
Result<std::unique_ptr<const RestCompliance>> open_rest_compliance(const ComplianceHeader& header,
                                                                   const HierarchicalIndex& hierarchy,
                                                                   std::unique_ptr<BlockSource> source,
                                                                   std::size_t table_bytes = 0);

}  // namespace souple
