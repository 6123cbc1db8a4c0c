// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "tools/compliance/compliance_system.hpp"
#include "tools/compliance/supernodal_factor.hpp"
#include "tools/compliance/worker_pool.hpp"

namespace souple {

/// A0^-1 on the free nodes by solves in double: the reference that a stored compliance is held against,
/// and the rows that it does not hold.
class RestSolver {
 public:
  /// Issues: those of SupernodalFactor::create.
  static Result<RestSolver> create(ComplianceSystem system, const FactorOptions& options);

  const ComplianceSystem& system() const { return system_; }
  Eigen::Index size() const { return 3 * Eigen::Index(system_.free_nodes.size()); }
  /// x <- A0^-1 x, by columns; rows are the free nodes, three each. The threads of the options share
  /// the columns; the bits do not depend on them. Issues: compliance_out_of_memory, interrupted.
  Status solve(Eigen::Ref<Eigen::MatrixXd> x) const;
  /// A0 x.
  Eigen::MatrixXd multiply(const Eigen::Ref<const Eigen::MatrixXd>& x) const;
  /// max over columns of ||A0 A0^-1 f - f||_2 / ||f||_2.
  Result<double> residual(const Eigen::Ref<const Eigen::MatrixXd>& f) const;

 private:
  RestSolver(ComplianceSystem system, SupernodalFactor factor, const FactorOptions& options);
  Status solve_block(SupernodalFactor::Workspace& workspace, Eigen::Ref<Eigen::MatrixXd> x) const;

  ComplianceSystem system_;
  SupernodalFactor factor_;
  std::function<bool()> cancelled_;
  std::unique_ptr<WorkerPool> pool_;
  mutable std::vector<SupernodalFactor::Workspace> workspaces_;  ///< by thread
};

/// Rows [first_row, first_row + rows) of the compliance on all nodes of the mesh, three rows a node,
/// fixed nodes zero: `out` is rows x 3 node_count, row-major, m/N. Issues: those of RestSolver::solve.
Status full_compliance_rows(const RestSolver& solver, Index node_count, std::int64_t first_row,
                            std::int64_t rows, std::span<double> out);

}  // namespace souple
