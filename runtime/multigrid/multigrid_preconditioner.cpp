// SPDX-License-Identifier: MIT
#include "runtime/multigrid/multigrid_preconditioner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple {
namespace {

/// Where the coarsest level is too large to be factorised, sweeps have to do.
constexpr int coarsest_sweep_count = 8;

/// Of the nodes' stiffness. Where it is larger, the residual between two coarse cycles would be
/// rounding: stiff parts move as rigid ones on soft ones, and hardly any of what a single holds is
/// left.
constexpr double most_contrast = 1e4;

void add(const PaddedVector& from, PaddedVector& to) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
}

}  // namespace

int sweeps_that_pay(Index node_count) { return node_count < 100000 ? 1 : 2; }

MultigridPreconditioner::Level::Level(const BlockPattern& pattern)
    : a(pattern),
      smoother(pattern.node_count()),
      b(4 * std::size_t(pattern.node_count())),
      x(b.size()),
      residual(b.size()),
      correction(b.size()),
      first(b.size()) {}

MultigridPreconditioner::MultigridPreconditioner(std::shared_ptr<const MultigridHierarchy> hierarchy,
                                                 int sweep_count)
    : hierarchy_(std::move(hierarchy)), sweep_count_(sweep_count) {
  levels_.reserve(hierarchy_->level_count());
  for (std::size_t l = 0; l < hierarchy_->level_count(); ++l)
    levels_.emplace_back(hierarchy_->pattern(l));
  const Index coarsest = levels_.back().a.pattern->node_count();
  if (coarsest <= coarsest_node_count(levels_.front().a.pattern->node_count()))
    dense_.emplace(coarsest);
}

bool MultigridPreconditioner::load(const BlockMatrix& a) {
  double largest = 0, least = std::numeric_limits<double>::infinity();
  for (std::size_t row = 0; row < a.pattern->diagonal.size(); ++row) {
    const double entry = a.block(a.pattern->diagonal[row]).diagonal().maxCoeff();
    largest = std::max(largest, entry);
    if (levels_.size() > 1 && hierarchy_->transition(0).transfer.holds(row))
      least = std::min(least, entry);
  }
  if (!(largest > 0) || !std::isfinite(largest)) return false;
  coarse_cycle_count_ = largest > most_contrast * least ? 1 : 2;
  scale_ = std::ldexp(1.0, -std::ilogb(largest));
  // What is left of the diagonal is not read.
  std::vector<float>& values = levels_.front().a.values;
  for (std::size_t row = 0; row < a.pattern->diagonal.size(); ++row)
    for (auto i = 9 * std::size_t(a.pattern->diagonal[row]);
         i < 9 * std::size_t(a.pattern->row_begin[row + 1]); ++i)
      values[i] = float(scale_ * a.values[i]);
  return true;
}

bool MultigridPreconditioner::update(const StepSystem& system) {
  if (!load(*system.tangent)) return false;
  for (std::size_t l = 0; l + 1 < levels_.size(); ++l)
    hierarchy_->transition(l).plan.replay(levels_[l].a, levels_[l + 1].a);
  const std::size_t smoothed = dense_ ? levels_.size() - 1 : levels_.size();
  for (std::size_t l = 0; l < smoothed; ++l)
    if (!levels_[l].smoother.update(levels_[l].a)) return false;
  return !dense_ || dense_->update(levels_.back().a);
}

void MultigridPreconditioner::smooth_before(Level& level, int sweep_count) {
  level.smoother.forward(level.a, level.b, level.x, level.residual);
  for (int sweep = 1; sweep < sweep_count; ++sweep) {
    // A further sweep is one from zero for what is missing.
    PaddedVector& rest = level.correction;
    rest.swap(level.residual);
    level.smoother.forward(level.a, rest, rest, level.residual);
    add(rest, level.x);
  }
}

void MultigridPreconditioner::smooth_after(Level& level, int sweep_count) {
  for (int sweep = 0; sweep < sweep_count; ++sweep)
    level.smoother.backward(level.a, level.b, level.x, level.residual);
}

void MultigridPreconditioner::solve_coarsest(Level& level) {
  if (dense_) {
    dense_->solve(level.b, level.x);
    return;
  }
  smooth_before(level, coarsest_sweep_count);
  smooth_after(level, coarsest_sweep_count);
}

void MultigridPreconditioner::cycle(std::size_t index) {
  Level& level = levels_[index];
  if (index + 1 == levels_.size()) return solve_coarsest(level);
  const PaddedTransfer& transfer = hierarchy_->transition(index).transfer;
  smooth_before(level, sweep_count_);
  transfer.restrict_to(level.residual, levels_[index + 1].b);
  visit(index + 1);
  transfer.add_prolonged(levels_[index + 1].x, level.x);
  smooth_after(level, sweep_count_);
}

void MultigridPreconditioner::visit(std::size_t index) {
  Level& level = levels_[index];
  cycle(index);
  if (coarse_cycle_count_ == 1 || index + 1 == levels_.size()) return;
  level.first.swap(level.x);
  GaussSeidel::subtract_product(level.a, level.first, level.b);
  cycle(index);
  add(level.first, level.x);
}

void MultigridPreconditioner::apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) {
  const double largest = r.cwiseAbs().maxCoeff();
  if (!(largest > 0) || !std::isfinite(largest)) {
    z.setZero();
    return;
  }
  Level& finest = levels_.front();
  const std::size_t node_count = finest.b.size() / 4;
  for (std::size_t i = 0; i < node_count; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      finest.b[4 * i + k] = float(r[Eigen::Index(3 * i + k)] / largest);
  cycle(0);
  const double factor = scale_ * largest;
  for (std::size_t i = 0; i < node_count; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      z[Eigen::Index(3 * i + k)] = factor * double(finest.x[4 * i + k]);
}

double MultigridPreconditioner::work_units() const {
  double work = 0, cycles = 1;
  for (const Level& level : levels_) {
    const double share =
        double(level.a.pattern->block_count()) / double(levels_.front().a.pattern->block_count());
    // In single precision; a pair of sweeps is one product, as many residuals between two cycles half.
    work += 0.5 * share * cycles * sweep_count_;
    if (cycles > 1) work += 0.5 * share * cycles / 4;
    cycles *= coarse_cycle_count_;
  }
  return work;
}

std::size_t MultigridPreconditioner::bytes() const {
  std::size_t sum = dense_ ? dense_->bytes() : 0;
  for (const Level& level : levels_)
    sum += (level.a.values.size() + 5 * level.b.size()) * sizeof(float) + level.smoother.bytes();
  return sum;
}

}  // namespace souple
