// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/rest_solver.hpp"

#include <algorithm>
#include <atomic>

namespace souple {
namespace {

constexpr Eigen::Index columns_at_once = 48;

}  // namespace

RestSolver::RestSolver(ComplianceSystem system, SupernodalFactor factor, const FactorOptions& options)
    : system_(std::move(system)),
      factor_(std::move(factor)),
      cancelled_(options.cancelled),
      pool_(std::make_unique<WorkerPool>(options.threads)) {
  for (unsigned worker = 0; worker < pool_->threads(); ++worker)
    workspaces_.emplace_back(factor_, columns_at_once);
}

Result<RestSolver> RestSolver::create(ComplianceSystem system, const FactorOptions& options) {
  auto factor = SupernodalFactor::create(*system.a0, system.free_nodes, options);
  if (!factor) {
    Issue issue = factor.issue();
    if (issue.where.empty()) issue.where = system.worst_element;
    return issue;
  }
  return RestSolver(std::move(system), std::move(*factor), options);
}

Status RestSolver::solve_block(SupernodalFactor::Workspace& workspace,
                               Eigen::Ref<Eigen::MatrixXd> x) const {
  const auto out_of_memory = [] {
    return make_issue(IssueCode::compliance_out_of_memory, "the solves ran out of memory");
  };
  const auto right_sides = workspace.right_sides();
  if (right_sides.empty()) return out_of_memory();
  Eigen::Map<Eigen::MatrixXd>(right_sides.data(), size(), x.cols()) = x;
  const auto solution = factor_.solve(workspace, static_cast<std::size_t>(x.cols()));
  if (solution.empty()) return out_of_memory();
  x = Eigen::Map<const Eigen::MatrixXd>(solution.data(), size(), x.cols());
  return {};
}

Status RestSolver::solve(Eigen::Ref<Eigen::MatrixXd> x) const {
  const auto blocks = static_cast<std::size_t>((x.cols() + columns_at_once - 1) / columns_at_once);
  std::vector<Status> status(blocks);
  std::atomic<bool> stopped{false};
  pool_->run(blocks, [&](std::size_t block, unsigned worker) {
    if (worker == 0 && cancelled_ && cancelled_()) stopped = true;
    if (stopped) return;
    const Eigen::Index first = Eigen::Index(block) * columns_at_once;
    status[block] = solve_block(workspaces_[worker],
                                x.middleCols(first, std::min(columns_at_once, x.cols() - first)));
  });
  if (stopped) return make_issue(IssueCode::interrupted, "the solves were stopped");
  for (const Status& s : status)
    if (!s) return s;
  return {};
}

Eigen::MatrixXd RestSolver::multiply(const Eigen::Ref<const Eigen::MatrixXd>& x) const {
  const BlockPattern& pattern = *system_.pattern;
  std::vector<Index> unknown(pattern.diagonal.size(), -1);
  for (std::size_t k = 0; k < system_.free_nodes.size(); ++k)
    unknown[std::size_t(system_.free_nodes[k])] = Index(k);
  Eigen::MatrixXd y = Eigen::MatrixXd::Zero(x.rows(), x.cols());
  for (std::size_t k = 0; k < system_.free_nodes.size(); ++k) {
    const auto node = std::size_t(system_.free_nodes[k]);
    for (Index b = pattern.row_begin[node]; b < pattern.row_begin[node + 1]; ++b) {
      const Index other = unknown[std::size_t(pattern.column[std::size_t(b)])];
      if (other >= 0)
        y.middleRows<3>(3 * Eigen::Index(k)).noalias() +=
            system_.a0->block(b) * x.middleRows<3>(3 * Eigen::Index(other));
    }
  }
  return y;
}

Result<double> RestSolver::residual(const Eigen::Ref<const Eigen::MatrixXd>& f) const {
  Eigen::MatrixXd u = f;
  if (auto status = solve(u); !status) return status.issue();
  return ((multiply(u) - f).colwise().norm().array() / f.colwise().norm().array()).maxCoeff();
}

Status full_compliance_rows(const RestSolver& solver, Index node_count, std::int64_t first_row,
                            std::int64_t rows, std::span<double> out) {
  // The matrix is symmetric: its rows are its columns.
  const std::vector<Index>& free = solver.system().free_nodes;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(solver.size(), rows);
  std::vector<char> moves(static_cast<std::size_t>(rows), 0);
  for (std::int64_t r = 0; r < rows; ++r) {
    const auto place = std::ranges::lower_bound(free, Index((first_row + r) / 3));
    if (place == free.end() || *place != Index((first_row + r) / 3)) continue;
    columns(3 * (place - free.begin()) + (first_row + r) % 3, r) = 1;
    moves[static_cast<std::size_t>(r)] = 1;
  }
  if (auto status = solver.solve(columns); !status) return status;
  std::ranges::fill(out, 0.0);
  for (std::int64_t r = 0; r < rows; ++r) {
    if (!moves[static_cast<std::size_t>(r)]) continue;
    double* row = out.data() + r * 3 * std::int64_t{node_count};
    for (std::size_t k = 0; k < free.size(); ++k)
      for (Eigen::Index d = 0; d < 3; ++d)
        row[3 * std::int64_t{free[k]} + d] = columns(3 * Eigen::Index(k) + d, r);
  }
  return {};
}

}  // namespace souple
