// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/supernodal_factor.hpp"

#include <cholmod.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "tools/compliance/blas_calls.hpp"
#include "tools/compliance/lower_pattern.hpp"
#include "tools/compliance/multifrontal.hpp"
#include "tools/compliance/node_ordering.hpp"

namespace souple {
namespace {

using Long = SuiteSparse_long;
static_assert(std::is_same_v<Long, std::int64_t>);

/// One cholmod_common: settings and memory counts of one thread.
struct Session {
  cholmod_common common;
  Session() {
    cholmod_l_start(&common);
    common.print = 0;
    blas::use_one_thread_per_call();
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session() { cholmod_l_finish(&common); }
};

Issue out_of_memory(const std::string& what) {
  return make_issue(IssueCode::compliance_out_of_memory, what);
}

// The supernodes of that order, and memory for their values.
cholmod_factor* analyse_supernodes(const BlockPattern& pattern, std::span<const Index> nodes,
                                   std::span<const Index> order, cholmod_common& common) {
  LowerPattern lower = lower_pattern(pattern, nodes, 3);
  cholmod_sparse view = as_sparse(lower);
  std::vector<Long> scalar_order;
  for (const Index node : order)
    for (Long c = 0; c < 3; ++c) scalar_order.push_back(3 * Long(node) + c);
  common.supernodal = CHOLMOD_SUPERNODAL;
  common.final_ll = 1;
  common.postorder = 0;  // it is in postorder
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_GIVEN;
  return cholmod_l_analyze_p(&view, scalar_order.data(), nullptr, 0, &common);
}

}  // namespace

struct SupernodalFactor::State {
  Session session;
  cholmod_factor* factor = nullptr;
  std::vector<Index> order;                    ///< local node at every place
  std::vector<std::int64_t> position_of_node;  ///< [nodes]
  ~State() { cholmod_l_free_factor(&factor, &session.common); }

  double* values() const { return static_cast<double*>(factor->x); }
  SupernodeView view() const {
    const auto longs = [](const void* data, std::size_t count) {
      return std::span(static_cast<const std::int64_t*>(data), count);
    };
    const std::size_t count = factor->nsuper;
    return {position_of_node,
            longs(factor->super, count + 1),
            longs(factor->pi, count + 1),
            longs(factor->s, factor->ssize),
            longs(factor->px, count + 1),
            {values(), values() ? factor->xsize : 0}};
  }
};

struct SupernodalFactor::Workspace::State {
  Session session;
  cholmod_dense* right_sides = nullptr;
  cholmod_dense *solution = nullptr, *work = nullptr, *sparse_work = nullptr;
  ~State() {
    for (auto** dense : {&right_sides, &solution, &work, &sparse_work})
      cholmod_l_free_dense(dense, &session.common);
  }
};

SupernodalFactor::SupernodalFactor(std::unique_ptr<State> state) : state_(std::move(state)) {}
SupernodalFactor::SupernodalFactor(SupernodalFactor&&) noexcept = default;
SupernodalFactor& SupernodalFactor::operator=(SupernodalFactor&&) noexcept = default;
SupernodalFactor::~SupernodalFactor() = default;

Result<SupernodalFactor> SupernodalFactor::create(const BlockMatrix& a, std::span<const Index> nodes,
                                                  const FactorOptions& options) {
  auto state = std::make_unique<State>();
  cholmod_common& common = state->session.common;
  state->order.assign(options.order.begin(), options.order.end());
  if (state->order.empty()) {
    auto order = order_nodes(*a.pattern, nodes, options.surface);
    if (!order) return order.issue();
    state->order = std::move(*order);
  }
  state->factor = analyse_supernodes(*a.pattern, nodes, state->order, common);
  if (!state->factor || !state->factor->is_super)
    return out_of_memory("the analysis of the system ran out of memory");
  state->position_of_node.resize(nodes.size());
  std::vector<std::int64_t> position(std::size_t(a.pattern->node_count()), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto node = std::size_t(state->order[k]);
    state->position_of_node[node] = position[std::size_t(nodes[node])] = 3 * std::int64_t(k);
  }
  const double needed = double(state->factor->xsize) * sizeof(double) +
                        multifrontal_bytes(state->view(), options.threads);
  if (needed > double(options.memory_limit_bytes))
    return out_of_memory("the factorisation needs " + std::to_string(std::llround(needed / 1e6)) +
                         " MB, allowed are " + std::to_string(options.memory_limit_bytes / 1000000) +
                         " MB");
  if (!cholmod_l_change_factor(CHOLMOD_REAL, 1, 1, 1, 1, state->factor, &common))
    return out_of_memory("the factorisation ran out of memory");
  const Status done = factorise({&a, nodes, state->order, position}, state->view(),
                                {state->values(), state->factor->xsize}, options);
  if (!done) return done.issue();
  return SupernodalFactor(std::move(state));
}

std::size_t SupernodalFactor::size() const { return state_->factor->n; }

SupernodeView SupernodalFactor::view() const { return state_->view(); }

std::size_t SupernodalFactor::bytes() const { return state_->factor->xsize * sizeof(double); }

SupernodalFactor::Workspace::Workspace(const SupernodalFactor& factor, std::size_t columns)
    : state_(std::make_unique<State>()) {
  state_->right_sides = cholmod_l_allocate_dense(factor.size(), columns, factor.size(), CHOLMOD_REAL,
                                                 &state_->session.common);
}
SupernodalFactor::Workspace::Workspace(Workspace&&) noexcept = default;
SupernodalFactor::Workspace::~Workspace() = default;

std::span<double> SupernodalFactor::Workspace::right_sides() {
  cholmod_dense* dense = state_->right_sides;
  if (!dense) return {};
  return {static_cast<double*>(dense->x), dense->nzmax};
}

std::span<const double> SupernodalFactor::solve(Workspace& workspace, std::size_t columns) const {
  Workspace::State& w = *workspace.state_;
  w.right_sides->ncol = columns;
  if (!cholmod_l_solve2(CHOLMOD_A, state_->factor, w.right_sides, nullptr, &w.solution, nullptr,
                        &w.work, &w.sparse_work, &w.session.common))
    return {};
  return {static_cast<const double*>(w.solution->x), size() * columns};
}

}  // namespace souple
