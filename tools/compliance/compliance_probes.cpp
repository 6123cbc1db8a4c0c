// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/compliance_probes.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "tools/compliance/extreme_eigenvalues.hpp"

namespace souple {
namespace {

constexpr Eigen::Index probe_count = 8;
constexpr double solve_tolerance = 1e-10;  // at which refinement ends
constexpr int lanczos_steps = 20;
// An error whose Frobenius norm, between D^-1/2, is below this needs no better bound.
constexpr double rough_bound = 1e-5;
constexpr int probing_steps = 6;
constexpr double probing_margin = 1.25;  // what so few steps may miss of a random matrix's edge
constexpr Eigen::Index lanczos_columns = 4;
constexpr Index block_nodes = 64;  // read at once

// Independent signs: E ||M f||^2 = ||M||_F^2. Bits of the generator, so the same everywhere.
Eigen::MatrixXd random_signs(Eigen::Index rows, Eigen::Index columns) {
  std::mt19937_64 random(20260101);
  Eigen::MatrixXd signs(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j)
    for (Eigen::Index i = 0; i < rows; ++i) signs(i, j) = (random() >> 40) & 1 ? 1 : -1;
  return signs;
}

/// Lower Cholesky factors of the diagonal blocks D.
std::vector<Mat3> diagonal_scales(const SymmetricSource& source) {
  std::vector<Mat3> scales(std::size_t(source.node_count()));
  Eigen::MatrixXd block(3, 3);
  for (Index row = 0; row < source.node_count(); ++row) {
    source.read({&row, 1}, {&row, 1}, block);
    scales[std::size_t(row)] = Mat3(block).llt().matrixL();
  }
  return scales;
}

/// x = S^-1 x, or S^-T x.
void divide_by_scales(const std::vector<Mat3>& scales, bool transposed, Eigen::MatrixXd& x) {
  for (std::size_t row = 0; row < scales.size(); ++row) {
    auto part = x.middleRows<3>(3 * Eigen::Index(row));
    if (transposed)
      scales[row].triangularView<Eigen::Lower>().transpose().solveInPlace(part);
    else
      scales[row].triangularView<Eigen::Lower>().solveInPlace(part);
  }
}

// max over the columns of ||A0 u - f|| / ||f||, on the free nodes.
double system_residual(const ComplianceSystem& system, const Eigen::MatrixXd& f,
                       const Eigen::Ref<const Eigen::MatrixXd>& u) {
  const BlockPattern& pattern = *system.pattern;
  std::vector<Index> unknown(std::size_t(pattern.node_count()), -1);
  for (std::size_t k = 0; k < system.free_nodes.size(); ++k)
    unknown[std::size_t(system.free_nodes[k])] = Index(k);
  Eigen::MatrixXd residual = Eigen::MatrixXd::Zero(u.rows(), u.cols());
  for (std::size_t row = 0; row < system.chosen.size(); ++row)
    residual.middleRows<3>(3 * Eigen::Index(system.chosen[row])) =
        -f.middleRows<3>(3 * Eigen::Index(row));
  for (std::size_t k = 0; k < system.free_nodes.size(); ++k) {
    const auto node = std::size_t(system.free_nodes[k]);
    for (Index b = pattern.row_begin[node]; b < pattern.row_begin[node + 1]; ++b) {
      const Index other = unknown[std::size_t(pattern.column[std::size_t(b)])];
      if (other < 0) continue;
      residual.middleRows<3>(3 * Eigen::Index(k)) +=
          system.a0->block(b) * u.middleRows<3>(3 * Eigen::Index(other));
    }
  }
  return (residual.colwise().norm().array() / f.colwise().norm().array()).maxCoeff();
}

/// u_s on the rows for the forces f; the residual of the solves is added to `worst`. False: no memory.
bool solve_exactly(const ComplianceSystem& system, const SupernodalFactor& factor,
                   const Eigen::MatrixXd& f, Eigen::MatrixXd& exact, double& worst) {
  SupernodalFactor::Workspace workspace(factor, std::size_t(f.cols()));
  const auto right_sides = workspace.right_sides();
  if (right_sides.empty()) return false;
  const auto size = Eigen::Index(factor.size());
  Eigen::Map<Eigen::MatrixXd> all(right_sides.data(), size, f.cols());
  all.setZero();
  for (std::size_t row = 0; row < system.chosen.size(); ++row)
    all.middleRows<3>(3 * Eigen::Index(system.chosen[row])) = f.middleRows<3>(3 * Eigen::Index(row));
  const auto solution = factor.solve(workspace, std::size_t(f.cols()));
  if (solution.empty()) return false;
  const Eigen::Map<const Eigen::MatrixXd> u(solution.data(), size, f.cols());
  worst = std::max(worst, system_residual(system, f, u));
  exact.resize(f.rows(), f.cols());
  for (std::size_t row = 0; row < system.chosen.size(); ++row)
    exact.middleRows<3>(3 * Eigen::Index(row)) = u.middleRows<3>(3 * Eigen::Index(system.chosen[row]));
  return true;
}

std::vector<Index> all_rows(const SymmetricSource& source) {
  std::vector<Index> rows(std::size_t(source.node_count()));
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

}  // namespace

Result<ComplianceError> probe_compliance(const ComplianceSystem& system, const SupernodalFactor& factor,
                                         const SymmetricSource& source,
                                         const ComplianceProduct& product) {
  const auto out_of_memory = [] {
    return make_issue(IssueCode::compliance_out_of_memory,
                      "the solves of the probes ran out of memory");
  };
  const Eigen::Index size = 3 * Eigen::Index(system.nodes.size());
  ComplianceError error;
  Eigen::MatrixXd f = random_signs(size, probe_count), exact, u(size, probe_count);
  if (!solve_exactly(system, factor, f, exact, error.solve_residual)) return out_of_memory();
  product(f, u);
  const Eigen::MatrixXd difference = u - exact;
  error.solve_residual =
      std::max(error.solve_residual,
               (difference.colwise().norm().array() / exact.colwise().norm().array()).maxCoeff());
  error.frobenius = difference.norm() / exact.norm();
  error.worst_column = std::sqrt(
      (difference.rowwise().squaredNorm().array() / exact.rowwise().squaredNorm().array()).maxCoeff());
  const auto scales = diagonal_scales(source);
  bool solved = true;
  const auto scaled_difference = [&](const Eigen::MatrixXd& x, Eigen::MatrixXd& y) {
    Eigen::MatrixXd force = x, motion(x.rows(), x.cols());
    divide_by_scales(scales, true, force);
    solved = solved && solve_exactly(system, factor, force, exact, error.solve_residual);
    if (!solved) return void(y.setZero(x.rows(), x.cols()));
    product(force, motion);
    y = motion - exact;
    divide_by_scales(scales, false, y);
  };
  scaled_difference(random_signs(size, probe_count), u);
  error.scaled_spectral = u.norm() / std::sqrt(double(probe_count));
  if (error.scaled_spectral > rough_bound) {  // worth a closer look
    const auto range = extreme_eigenvalues(scaled_difference, size, lanczos_columns, probing_steps);
    const double spectral = std::max(std::abs(range.smallest), std::abs(range.largest));
    error.scaled_spectral = std::min(error.scaled_spectral, probing_margin * spectral);
  }
  if (!solved) return out_of_memory();
  return error;
}

double probe_solves(const ComplianceSystem& system, const SurfaceInverse& solves) {
  const Eigen::MatrixXd f = random_signs(3 * Eigen::Index(solves.node_count()), probe_count);
  Eigen::MatrixXd x = f;
  SurfaceInverse::Work work;
  solves.apply_refined(solves.places(), x, solve_tolerance, work);
  return system_residual(system, f, solves.solution_on_free_nodes(work));
}

namespace {

void measure_columns(const SymmetricSource& source, const RestCompliance& stored,
                     ComplianceError& error) {
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const std::vector<Index> rows = all_rows(source);
  const Eigen::Index size = 3 * Eigen::Index(rows.size());
  ComplianceWork work;
  double error2 = 0, norm2 = 0, worst2 = 0;
  for (std::size_t first = 0; first < rows.size(); first += std::size_t(block_nodes)) {
    const auto some =
        std::span(rows).subspan(first, std::min(rows.size() - first, std::size_t(block_nodes)));
    const auto width = 3 * Eigen::Index(some.size());
    Eigen::MatrixXd exact(size, width);
    RowMajor given(size, width);
    source.read(rows, some, exact);
    stored.gather_block(rows, some, given.data(), std::size_t(width), work);
    const Eigen::MatrixXd difference = exact - given.cast<double>();
    const auto errors = difference.colwise().squaredNorm(), norms = exact.colwise().squaredNorm();
    worst2 = std::max(worst2, (errors.array() / norms.array()).maxCoeff());
    error2 += errors.sum();
    norm2 += norms.sum();
  }
  error.frobenius = std::sqrt(error2 / norm2);
  error.worst_column = std::sqrt(worst2);
}

}  // namespace

void measure_stored(const SymmetricSource& source, const RestCompliance& stored,
                    const ComplianceProduct& product, ComplianceError& error) {
  measure_columns(source, stored, error);
  const auto scales = diagonal_scales(source);
  const std::vector<Index> rows = all_rows(source);
  const Eigen::Index size = 3 * Eigen::Index(rows.size());
  ComplianceWork work;
  const auto scaled_difference = [&](const Eigen::MatrixXd& x, Eigen::MatrixXd& y) {
    Eigen::MatrixXd f = x;
    divide_by_scales(scales, true, f);
    y.resize(size, x.cols());
    product(f, y);
    Eigen::VectorXd given(size);
    for (Eigen::Index k = 0; k < x.cols(); ++k) {
      stored.apply(rows, {f.col(k).data(), std::size_t(size)}, {given.data(), std::size_t(size)}, work);
      y.col(k) -= given;
    }
    divide_by_scales(scales, false, y);
  };
  const auto range = extreme_eigenvalues(scaled_difference, size, lanczos_columns, lanczos_steps);
  error.scaled_spectral = std::max(std::abs(range.smallest), std::abs(range.largest));
}

}  // namespace souple
