// SPDX-License-Identifier: MIT
#include "runtime/multigrid/galerkin_plan.hpp"

#include <algorithm>
#include <utility>

namespace souple {

GalerkinPlan GalerkinPlan::create(const BlockPattern& fine, const Prolongation& p) {
  return choose(fine, p, plan_row_products(fine, p));
}

Result<GalerkinPlan> GalerkinPlan::open(const BlockPattern& fine, const LevelTransition& stored,
                                        std::span<const Index> fixed) {
  Result<RowProductsPlan> rows = open_row_products(fine, stored, fixed);
  if (!rows) return rows.issue();
  return choose(fine, prolongation_of(stored), std::move(*rows));
}

GalerkinPlan GalerkinPlan::choose(const BlockPattern& fine, const Prolongation& p,
                                  RowProductsPlan rows) {
  Index most = 0;
  for (std::size_t i = 0; i + 1 < p.row_begin.size(); ++i)
    most = std::max(most, p.row_begin[i + 1] - p.row_begin[i]);
  GalerkinPlan plan;
  if (most <= 2)
    plan.products_ = FusedTerms::create(fine, rows);
  else
    plan.products_ = std::move(rows.products);
  plan.pattern_ = std::move(rows.pattern);
  plan.lone_ = std::move(rows.lone);
  return plan;
}

void GalerkinPlan::replay(const BlockMatrixF& fine, BlockMatrixF& coarse) const {
  std::visit([&](const auto& products) { products.replay(fine, coarse); }, products_);
  for (const Index node : lone_) coarse.block(pattern_.diagonal[std::size_t(node)]).setIdentity();
}

std::size_t GalerkinPlan::bytes() const {
  return lone_.size() * sizeof(Index) +
         std::visit([](const auto& products) { return products.bytes(); }, products_);
}

double GalerkinPlan::flops() const {
  return std::visit([](const auto& products) { return products.flops(); }, products_);
}

}  // namespace souple
