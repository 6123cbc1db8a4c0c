// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "runtime/compliance/rest_compliance.hpp"

namespace souple {

/// The rest compliance of a coarser level carried up to the finest one (METHOD 6): C = P C_coarse P^T,
/// where row i of P holds the weights of `prolongation[i]`. Positive semi-definite like C_coarse; of
/// lower rank where it has more rows than that.
class ProlongedCompliance final : public RestCompliance {
 public:
  /// One prolongation per row; its rows are those of `coarse`. `where` names the variant in an issue.
  /// Issue asset_corrupt: no rows, a row outside `coarse`, a weight that is not finite or beyond 1e3.
  static Result<std::unique_ptr<const RestCompliance>> create(
      std::unique_ptr<const RestCompliance> coarse, std::vector<RowProlongation> prolongation,
      const std::string& where);

  Index row_count() const override { return static_cast<Index>(prolongation_.size()); }
  bool ready(std::span<const Index> rows) const override;
  bool ready_to_apply(std::span<const Index> rows) const override;
  /// Allocates its scratch memory; the other evaluations do not once `work` has grown.
  void gather(std::span<const Index> rows, std::span<double> out) const override;
  void gather_block(std::span<const Index> rows, std::span<const Index> columns, float* out,
                    std::size_t stride, ComplianceWork& work) const override;
  void apply(std::span<const Index> rows, std::span<const double> force, std::span<double> displacement,
             ComplianceWork& work) const override;
  std::size_t resident_bytes() const override;
  std::size_t table_bytes() const override { return coarse_->table_bytes(); }

 private:
  ProlongedCompliance(std::unique_ptr<const RestCompliance> coarse,
                      std::vector<RowProlongation> prolongation);

  std::unique_ptr<const RestCompliance> coarse_;
  std::vector<RowProlongation> prolongation_;
};

}  // namespace souple
