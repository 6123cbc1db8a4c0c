// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/deep_check.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <string>

#include "runtime/compliance/open_variant.hpp"
#include "tools/compliance/rest_solver.hpp"

namespace souple {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Lanczos bounds from below and the header may round its own estimate: a claim is false beyond this.
constexpr double claim_margin = 1.1;
// Entries, and sums of them, are evaluated in single precision.
constexpr double column_rounding = 2e-6, spectral_rounding = 4e-7;
constexpr double largest_residual = 1e-6;

/// The exact compliance on the variant's nodes, and the stored one, as operators on 3n vectors.
class Pair {
 public:
  Pair(const RestSolver& solver, std::vector<Eigen::Index> unknown_of_row, const RestCompliance& stored)
      : solver_(solver), unknown_(std::move(unknown_of_row)), stored_(stored), rows_(unknown_.size()) {
    std::iota(rows_.begin(), rows_.end(), 0);
  }

  Eigen::Index size() const { return 3 * Eigen::Index(rows_.size()); }

  Result<MatrixXd> exact(const MatrixXd& x) const {
    MatrixXd full = MatrixXd::Zero(solver_.size(), x.cols());
    for (std::size_t r = 0; r < unknown_.size(); ++r)
      full.middleRows<3>(unknown_[r]) = x.middleRows<3>(3 * Eigen::Index(r));
    if (auto status = solver_.solve(full); !status) return status.issue();
    MatrixXd y(size(), x.cols());
    for (std::size_t r = 0; r < unknown_.size(); ++r)
      y.middleRows<3>(3 * Eigen::Index(r)) = full.middleRows<3>(unknown_[r]);
    return y;
  }

  VectorXd stored(const VectorXd& x) const {
    VectorXd y(size());
    stored_.apply(rows_, {x.data(), std::size_t(x.size())}, {y.data(), std::size_t(y.size())}, work_);
    return y;
  }

  /// One column of the stored compliance.
  VectorXd stored_column(Index row, int axis) const {
    std::array<double, 3> force{};
    force[std::size_t(axis)] = 1;
    VectorXd y(size());
    stored_.apply({&row, 1}, force, {y.data(), std::size_t(y.size())}, work_);
    return y;
  }

  /// D, the diagonal blocks: the stored ones, which differ from the exact ones by the error itself ...
  std::vector<Mat3> stored_diagonal() const {
    std::vector<Mat3> blocks;
    for (Index row = 0; row < Index(rows_.size()); ++row) {
      std::array<float, 9> block{};
      stored_.gather_block({&row, 1}, {&row, 1}, block.data(), 3, work_);
      blocks.push_back(
          Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(block.data()).cast<double>());
    }
    return blocks;
  }
  /// ... or the exact ones, by three solves a node.
  Result<std::vector<Mat3>> exact_diagonal() const {
    constexpr Index nodes_at_once = 16;
    std::vector<Mat3> blocks;
    const auto count = Index(rows_.size());
    for (Index first = 0; first < count; first += nodes_at_once) {
      const Index nodes = std::min(nodes_at_once, count - first);
      MatrixXd unit = MatrixXd::Zero(size(), 3 * nodes);
      unit.block(3 * first, 0, 3 * nodes, 3 * nodes).setIdentity();
      const auto columns = exact(unit);
      if (!columns) return columns.issue();
      for (Index k = 0; k < nodes; ++k) blocks.push_back(columns->block<3, 3>(3 * (first + k), 3 * k));
    }
    return blocks;
  }

 private:
  const RestSolver& solver_;
  std::vector<Eigen::Index> unknown_;  ///< first scalar of every row among the free ones
  const RestCompliance& stored_;
  std::vector<Index> rows_;
  mutable ComplianceWork work_;
};

VectorXd random_unit(Eigen::Index size, std::mt19937& random) {
  VectorXd x(size);
  for (double& value : x) value = 2.0 * double(random()) / 4294967296.0 - 1;
  return x.normalized();
}

/// L^-T x, and L^-1 x, block by block.
VectorXd from_scaled(const std::vector<Mat3>& scales, const VectorXd& x) {
  VectorXd y(x.size());
  for (std::size_t r = 0; r < scales.size(); ++r)
    y.segment<3>(3 * Eigen::Index(r)) =
        scales[r].triangularView<Eigen::Lower>().transpose().solve(x.segment<3>(3 * Eigen::Index(r)));
  return y;
}
VectorXd to_scaled(const std::vector<Mat3>& scales, const VectorXd& x) {
  VectorXd y(x.size());
  for (std::size_t r = 0; r < scales.size(); ++r)
    y.segment<3>(3 * Eigen::Index(r)) =
        scales[r].triangularView<Eigen::Lower>().solve(x.segment<3>(3 * Eigen::Index(r)));
  return y;
}

/// Largest |eigenvalue| of a symmetric operator from below, by Lanczos iteration with full
/// orthogonalisation.
template <class Apply>
Result<double> largest_eigenvalue(Eigen::Index size, int steps, std::mt19937& random,
                                  const Apply& apply) {
  steps = int(std::min<Eigen::Index>(steps, size));
  MatrixXd basis(size, steps), small = MatrixXd::Zero(steps, steps);
  basis.col(0) = random_unit(size, random);
  int used = 0;
  for (int k = 0; k < steps; ++k) {
    Result<VectorXd> image = apply(VectorXd(basis.col(k)));
    if (!image) return image.issue();
    VectorXd& w = *image;
    used = k + 1;
    small(k, k) = basis.col(k).dot(w);
    for (int pass = 0; pass < 2; ++pass)
      w -= basis.leftCols(used) * (basis.leftCols(used).transpose() * w).eval();
    const double norm = w.norm();
    if (k + 1 == steps || !(norm > 1e-14 * small.cwiseAbs().maxCoeff())) break;
    small(k, k + 1) = small(k + 1, k) = norm;
    basis.col(k + 1) = w / norm;
  }
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(small.topLeftCorner(used, used))
      .eigenvalues()
      .cwiseAbs()
      .maxCoeff();
}

/// Lower Cholesky factors of the blocks; empty if one is not positive.
std::vector<Mat3> lower_factors(const std::vector<Mat3>& blocks) {
  std::vector<Mat3> factors;
  for (const Mat3& block : blocks) {
    const Eigen::LLT<Mat3> factor(block);
    if (!block.allFinite() || factor.info() != Eigen::Success) return {};
    factors.push_back(factor.matrixL());
  }
  return factors;
}

/// `is_coarse`: the stored diagonal is too far from the exact one to stand for it.
Status measure_spectral(const Pair& pair, bool is_coarse, const DeepCheckOptions& options,
                        DeepCheck& check) {
  Result<std::vector<Mat3>> diagonal = is_coarse ? pair.exact_diagonal() : pair.stored_diagonal();
  if (!diagonal) return diagonal.issue();
  const std::vector<Mat3> scales = lower_factors(*diagonal);
  if (scales.empty()) {
    check.least_curvature = -1;
    return {};
  }
  check.least_curvature = std::numeric_limits<double>::infinity();
  std::mt19937 random(options.seed);
  const auto stored = [&](const VectorXd& x) -> Result<VectorXd> {
    VectorXd y = to_scaled(scales, pair.stored(from_scaled(scales, x)));
    check.least_curvature = std::min(check.least_curvature, x.dot(y));
    return y;
  };
  int done = 0;
  const auto difference = [&](const VectorXd& x) -> Result<VectorXd> {
    if (options.progress) options.progress(0.2 + 0.7 * done++ / options.lanczos_steps);
    const auto exact = pair.exact(from_scaled(scales, x));
    if (!exact) return exact.issue();
    return VectorXd(to_scaled(scales, exact->col(0)) - *stored(x));
  };
  const auto error = largest_eigenvalue(pair.size(), options.lanczos_steps, random, difference);
  if (!error) return error.issue();
  check.scaled_spectral = *error;
  const auto norm = largest_eigenvalue(pair.size(), 10, random, stored);
  if (!norm) return norm.issue();
  check.rounding = spectral_rounding * *norm;
  return {};
}

Status measure_columns(const Pair& pair, const DeepCheckOptions& options, DeepCheck& check) {
  const auto row_count = Index(pair.size() / 3);
  std::vector<Index> rows(static_cast<std::size_t>(row_count));
  std::iota(rows.begin(), rows.end(), 0);
  std::mt19937 random(options.seed + 1);
  const auto count = std::size_t(std::min(options.column_nodes, row_count));
  for (std::size_t k = 0; k < count; ++k) std::swap(rows[k], rows[k + random() % (rows.size() - k)]);
  double difference2 = 0, norm2 = 0;
  for (std::size_t k = 0; k < count; ++k) {
    MatrixXd unit = MatrixXd::Zero(pair.size(), 3);
    for (int axis = 0; axis < 3; ++axis) unit(3 * Eigen::Index(rows[k]) + axis, axis) = 1;
    const auto exact = pair.exact(unit);
    if (!exact) return exact.issue();
    for (int axis = 0; axis < 3; ++axis) {
      const double d2 = (exact->col(axis) - pair.stored_column(rows[k], axis)).squaredNorm();
      const double n2 = exact->col(axis).squaredNorm();
      check.worst_column = std::max(check.worst_column, std::sqrt(d2 / n2));
      difference2 += d2;
      norm2 += n2;
    }
  }
  check.frobenius = std::sqrt(difference2 / norm2);
  return {};
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

/// What the header says against what was measured, and against the tolerance.
void judge(const ComplianceHeader& header, DeepCheck& check) {
  const auto refuse = [&](const std::string& what) {
    check.false_claims.push_back(
        make_issue(IssueCode::compliance_claim_false, what, "compliance/" + header.name));
  };
  const auto compare = [&](const char* name, double measured, double claimed, double rounding) {
    if (!(measured <= claim_margin * claimed + rounding))
      refuse(std::string(name) + ": measured at least " + number(measured) + ", stated " +
             number(claimed));
  };
  const ComplianceError& claimed = header.error;
  // D of the stored form makes the measure as much larger at most as the error itself.
  const double scale = header.coarsening > 0 ? 1 : 1 + 2 * claimed.scaled_spectral;
  compare("scaled spectral error", check.scaled_spectral, claimed.scaled_spectral * scale,
          check.rounding);
  compare("worst column", check.worst_column, claimed.worst_column, column_rounding);
  // A sample of the columns: their share of the whole norm may differ by more than the claim's margin.
  compare("Frobenius error", check.frobenius, 1.5 * claimed.frobenius, column_rounding);
  if (check.least_curvature < -check.rounding)
    refuse("not positive semi-definite: x^T C x / x^T D x = " + number(check.least_curvature));
  const std::array<double, 3> norms{claimed.scaled_spectral, claimed.frobenius, claimed.worst_column};
  const double stated = norms[std::size_t(header.error_norm)];
  if (header.tolerance_asked > 0 && header.coarsening == 0 && stated > header.tolerance_asked)
    refuse("states an error of " + number(stated) + " where " + number(header.tolerance_asked) +
           " was asked for");
}

struct Reference {
  RestSolver solver;
  std::vector<Eigen::Index> unknown_of_row;
};

/// A0, factorised, with every one of the variant's nodes found in it.
Result<Reference> make_reference(const ComplianceVariant& variant, const MeshLevel& level,
                                 const Material& material, const FixedSet* fixed,
                                 const FactorOptions& options) {
  PreparedBody body(level, material);
  auto system = build_system(body, fixed, variant.nodes, variant.header.mass_factor,
                             variant.header.stiffness_factor);
  if (!system) return system.issue();
  if (system->nodes != variant.nodes)
    return make_issue(IssueCode::asset_compliance_invalid,
                      "its nodes are not free nodes of the surface",
                      "compliance/" + variant.header.name);
  auto solver = RestSolver::create(std::move(*system), options);
  if (!solver) return solver.issue();
  std::vector<Eigen::Index> unknown;
  for (const Index place : solver->system().chosen) unknown.push_back(3 * Eigen::Index(place));
  return Reference{std::move(*solver), std::move(unknown)};
}

}  // namespace

Result<DeepCheck> check_deeply(const ComplianceVariant& variant, const MeshLevel& level,
                               const Material& material, const FixedSet* fixed,
                               const DeepCheckOptions& options) {
  auto stored = open_variant(variant);
  if (!stored) return stored.issue();
  auto reference = make_reference(variant, level, material, fixed, options.factor);
  if (!reference) return reference.issue();
  const RestSolver& solver = reference->solver;
  DeepCheck check;
  std::mt19937 random(options.seed + 2);
  MatrixXd probes(solver.size(), 4);
  for (auto column : probes.colwise()) column = random_unit(solver.size(), random);
  const auto residual = solver.residual(probes);
  if (!residual) return residual.issue();
  check.reference_residual = *residual;
  if (!(*residual <= largest_residual))
    return make_issue(IssueCode::compliance_residual_too_large,
                      "the reference itself is " + number(*residual) + " off",
                      solver.system().worst_element);
  const Pair pair(solver, std::move(reference->unknown_of_row), **stored);
  if (auto status = measure_spectral(pair, variant.header.coarsening > 0, options, check); !status)
    return status.issue();
  if (auto status = measure_columns(pair, options, check); !status) return status.issue();
  judge(variant.header, check);
  return check;
}

}  // namespace souple
