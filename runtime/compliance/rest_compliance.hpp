// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "runtime/compliance/block_source.hpp"
#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// The rest compliance C0 on the n nodes of a variant: symmetric positive definite, 3n x 3n, m/N, rest
/// frame. `row` counts these nodes, 0 <= row < n. Representations (dense now, compressed ones later)
/// differ only behind this interface. Const and shared; evaluation allocates nothing.
class RestCompliance {
 public:
  virtual ~RestCompliance() = default;
  virtual Index row_count() const = 0;
  /// Whether every block that the next calls with these rows need is in memory.
  virtual bool ready(std::span<const Index> rows) const = 0;
  /// out = C0 on rows x rows, dense, row-major, (3m) x (3m) with leading dimension 3m.
  virtual void gather(std::span<const Index> rows, std::span<double> out) const = 0;
  /// displacement = C0(:, rows) force: `force` holds 3 values per row, `displacement` 3n.
  virtual void apply(std::span<const Index> rows, std::span<const double> force,
                     std::span<double> displacement) const = 0;
  virtual std::size_t resident_bytes() const = 0;
};

/// Opens the representation that the header names. Issues: unsupported_feature, asset_corrupt (sizes).
Result<std::unique_ptr<const RestCompliance>> open_rest_compliance(const ComplianceHeader& header,
                                                                   std::unique_ptr<BlockSource> source);

}  // namespace souple
