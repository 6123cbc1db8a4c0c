// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/supernodal_factor.hpp"

#include <cholmod.h>

#include <algorithm>
#include <vector>

// OpenBLAS threads under contention make supernodal solves many times slower, and their sums depend on
// the thread count: the parallelism is over independent right sides instead.
extern "C" void openblas_set_num_threads(int count);

namespace souple {
namespace {

/// One cholmod_common: settings and memory counts of one thread.
struct Session {
  cholmod_common common;
  Session() {
    cholmod_l_start(&common);
    common.print = 0;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_ll = 1;
    openblas_set_num_threads(1);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session() { cholmod_l_finish(&common); }
};

/// The lower triangle of the chosen part, by columns.
struct LowerTriangle {
  std::vector<SuiteSparse_long> begin{0}, row;
  std::vector<double> value;
};

// A is symmetric: the lower triangle by columns is read from the rows of its upper triangle.
LowerTriangle lower_triangle(const BlockMatrix& a, std::span<const Index> nodes) {
  const BlockPattern& pattern = *a.pattern;
  std::vector<Index> local(std::size_t(pattern.node_count()), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k) local[std::size_t(nodes[k])] = Index(k);
  LowerTriangle lower;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (int c = 0; c < 3; ++c) {
      const SuiteSparse_long column = 3 * SuiteSparse_long(k) + c;
      for (Index b = pattern.row_begin[nodes[k]]; b < pattern.row_begin[nodes[k] + 1]; ++b)
        for (int r = 0; r < 3; ++r) {
          const Index other = local[std::size_t(pattern.column[b])];
          const SuiteSparse_long row = 3 * SuiteSparse_long(other) + r;
          if (other < 0 || row < column) continue;
          lower.row.push_back(row);
          lower.value.push_back(a.block(b)(c, r));
        }
      lower.begin.push_back(SuiteSparse_long(lower.row.size()));
    }
  return lower;
}

cholmod_sparse sparse_view(LowerTriangle& lower) {
  cholmod_sparse view{};
  view.nrow = view.ncol = lower.begin.size() - 1;
  view.nzmax = lower.row.size();
  view.p = lower.begin.data();
  view.i = lower.row.data();
  view.x = lower.value.data();
  view.stype = -1;
  view.itype = CHOLMOD_LONG;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

}  // namespace

struct SupernodalFactor::State {
  Session session;
  cholmod_factor* factor = nullptr;
  ~State() { cholmod_l_free_factor(&factor, &session.common); }
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
                                                  std::size_t memory_limit_bytes) {
  auto state = std::make_unique<State>();
  LowerTriangle lower = lower_triangle(a, nodes);
  cholmod_sparse view = sparse_view(lower);
  cholmod_common& common = state->session.common;
  state->factor = cholmod_l_analyze(&view, &common);
  if (!state->factor || common.status == CHOLMOD_OUT_OF_MEMORY)
    return make_issue(IssueCode::compliance_out_of_memory,
                      "the analysis of the system ran out of memory");
  const double needed = common.lnz * sizeof(double);
  if (needed > double(memory_limit_bytes))
    return make_issue(IssueCode::compliance_out_of_memory,
                      "the factor needs " + std::to_string(needed / 1e6) + " MB, allowed are " +
                          std::to_string(double(memory_limit_bytes) / 1e6) + " MB");
  cholmod_l_factorize(&view, state->factor, &common);
  if (common.status == CHOLMOD_OUT_OF_MEMORY)
    return make_issue(IssueCode::compliance_out_of_memory, "the factorisation ran out of memory");
  if (common.status != CHOLMOD_OK || state->factor->minor != state->factor->n)
    return make_issue(IssueCode::compliance_factorisation_failed,
                      "the system matrix is not positive definite");
  return SupernodalFactor(std::move(state));
}

std::size_t SupernodalFactor::size() const { return state_->factor->n; }

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
