// SPDX-License-Identifier: MIT
#include "runtime/fem/sparse_factor.hpp"

#include <algorithm>
#include <array>

#include "runtime/fem/dense_tiles.hpp"

namespace souple {
namespace {

using Panel = Eigen::Map<const Eigen::MatrixXd>;
using Values = Eigen::Ref<Eigen::VectorXd>;

constexpr std::size_t chunk_nodes = 32;  // of a border, gathered at a time

}  // namespace

void SparseFactor::analyze(const BlockPattern& pattern, std::span<const Point> positions,
                           std::span<const Index> nodes) {
  plan_ = make_front_plan(pattern, positions, nodes);
  std::vector<Index> place_of(std::size_t(pattern.node_count()), -1);
  for (std::size_t k = 0; k < plan_.order.size(); ++k) place_of[std::size_t(plan_.order[k])] = Index(k);
  place_.clear();
  for (const Index node : nodes) place_.push_back(place_of[std::size_t(node)]);
  panels_.resize(plan_.panel_scalars);
  stack_.resize(plan_.stack_scalars);
  update_.resize(plan_.update_scalars);
  std::size_t strips = 0;
  for (const FrontPlan::Front& front : plan_.fronts)
    strips = std::max(strips, square_work(3 * front.border(), 3 * front.own()));
  strips_.resize(strips);
}

bool SparseFactor::factorize(const BlockMatrix& a) {
  open_ = 0;
  for (const FrontPlan::Front& front : plan_.fronts) {
    const std::size_t size = 3 * front.size(), own = 3 * front.own(), border = size - own;
    double* const panel = panels_.data() + front.panel_begin;
    load_front(front, a);
    for (std::size_t k = front.child_begin; k < front.child_end; ++k)
      add_update(plan_.fronts[std::size_t(plan_.children[k])], front);
    if (!factorize_panel(panel, size, own)) return false;
    if (border == 0) continue;
    subtract_square({panel + own, size, border, own}, update_.data(), stack_.data() + open_,
                    strips_.data());
    open_ += border * border;
  }
  return true;
}

// The rows of A's own nodes; a row of a block is three rows of a column of the front.
void SparseFactor::load_front(const FrontPlan::Front& front, const BlockMatrix& a) {
  const std::size_t size = 3 * front.size();
  double* const panel = panels_.data() + front.panel_begin;
  std::fill_n(panel, size * 3 * front.own(), 0.0);
  std::fill_n(update_.data(), 9 * front.border() * front.border(), 0.0);
  for (std::size_t k = front.entry_begin; k < front.entry_end; ++k) {
    const FrontPlan::Entry& entry = plan_.entries[k];
    const double* const block = a.values.data() + 9 * std::size_t(entry.block);
    double* const out = panel + 3 * std::size_t(entry.column) * size + 3 * std::size_t(entry.row);
    for (std::size_t c = 0; c < 3; ++c) std::copy_n(block + 3 * c, 3, out + c * size);
  }
}

// The last of the open updates is added to the front.
void SparseFactor::add_update(const FrontPlan::Front& child, const FrontPlan::Front& front) {
  const std::size_t count = child.border(), rows = 3 * count;
  open_ -= rows * rows;
  const double* column = stack_.data() + open_;
  const Index* const map = plan_.map.data() + child.map_begin;
  const std::size_t own = front.own();
  for (std::size_t j = 0; j < count; ++j) {
    const auto target = std::size_t(map[j]);
    const bool in_panel = target < own;
    const std::size_t stride = 3 * (in_panel ? front.size() : front.border());
    const std::size_t offset = in_panel ? 0 : own;
    double* out = (in_panel ? panels_.data() + front.panel_begin : update_.data()) +
                  3 * (target - offset) * stride;
    for (std::size_t c = 0; c < 3; ++c, column += rows, out += stride)
      for (std::size_t i = j; i < count; ++i)
        for (std::size_t r = 0; r < 3; ++r)
          out[3 * (std::size_t(map[i]) - offset) + r] += column[3 * i + r];
  }
}

// x_c = L_cc^-1 x_c, x_r -= L_rc x_c.
void SparseFactor::forward(const FrontPlan::Front& front, Values y) const {
  const auto size = Eigen::Index(3 * front.size()), own = Eigen::Index(3 * front.own());
  const Panel l(panel(front), size, own);
  auto own_y = y.segment(3 * Eigen::Index{front.begin}, own);
  l.topRows(own).triangularView<Eigen::Lower>().solveInPlace(own_y);
  std::array<double, 3 * chunk_nodes> values;
  for (std::size_t k = 0; k < front.border(); k += chunk_nodes) {
    const std::size_t count = std::min(chunk_nodes, front.border() - k);
    Eigen::Map<Eigen::VectorXd> part(values.data(), Eigen::Index(3 * count));
    part.noalias() = l.middleRows(own + Eigen::Index(3 * k), part.size()) * own_y;
    for (std::size_t i = 0; i < count; ++i)
      y.segment<3>(3 * Eigen::Index{plan_.border[front.border_begin + k + i]}) -=
          part.segment<3>(Eigen::Index(3 * i));
  }
}

// x_c = L_cc^-T (x_c - L_rc^T x_r).
void SparseFactor::backward(const FrontPlan::Front& front, Values y) const {
  const auto size = Eigen::Index(3 * front.size()), own = Eigen::Index(3 * front.own());
  const Panel l(panel(front), size, own);
  auto own_y = y.segment(3 * Eigen::Index{front.begin}, own);
  std::array<double, 3 * chunk_nodes> values;
  for (std::size_t k = 0; k < front.border(); k += chunk_nodes) {
    const std::size_t count = std::min(chunk_nodes, front.border() - k);
    Eigen::Map<Eigen::VectorXd> part(values.data(), Eigen::Index(3 * count));
    for (std::size_t i = 0; i < count; ++i)
      part.segment<3>(Eigen::Index(3 * i)) =
          y.segment<3>(3 * Eigen::Index{plan_.border[front.border_begin + k + i]});
    own_y.noalias() -= l.middleRows(own + Eigen::Index(3 * k), part.size()).transpose() * part;
  }
  l.topRows(own).triangularView<Eigen::Lower>().transpose().solveInPlace(own_y);
}

void SparseFactor::solve(Values x, Values work) const {
  for (std::size_t k = 0; k < place_.size(); ++k)
    work.segment<3>(3 * Eigen::Index{place_[k]}) = x.segment<3>(3 * Eigen::Index(k));
  for (const FrontPlan::Front& front : plan_.fronts) forward(front, work);
  for (std::size_t k = plan_.fronts.size(); k-- > 0;) backward(plan_.fronts[k], work);
  for (std::size_t k = 0; k < place_.size(); ++k)
    x.segment<3>(3 * Eigen::Index(k)) = work.segment<3>(3 * Eigen::Index{place_[k]});
}

void SparseFactor::inverse_block(std::span<const Index> chosen, std::span<double> block,
                                 InverseBlockWork& work) const {
  work.evaluate(plan_, panels_.data(), place_, chosen, block);
}

std::size_t SparseFactor::bytes() const {
  return (panels_.size() + stack_.size() + update_.size() + strips_.size()) * sizeof(double) +
         plan_.entries.size() * sizeof(plan_.entries[0]) +
         plan_.fronts.size() * sizeof(plan_.fronts[0]) +
         (plan_.order.size() + plan_.border.size() + plan_.children.size() + plan_.map.size() +
          place_.size()) *
             sizeof(Index);
}

}  // namespace souple
