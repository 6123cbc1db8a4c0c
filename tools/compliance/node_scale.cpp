// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/node_scale.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace souple {
namespace {

constexpr Index strip_nodes = 32;  // columns read at once

using Scale = std::array<float, 6>;

// A mantissa of 12 bits is enough for a scale and compresses well.
float coarse(double value) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return float(std::ldexp(std::round(mantissa * 4096) / 4096, exponent));
}

Result<NodeScaling> spectral_scaling(const SymmetricSource& source, double tolerance) {
  NodeScaling scaling;
  for (Index row = 0; row < source.node_count(); ++row) {
    Eigen::MatrixXd block(3, 3);
    source.read({&row, 1}, {&row, 1}, block);
    const Eigen::LLT<Eigen::Matrix3d> factor{Eigen::Matrix3d(block)};
    if (factor.info() != Eigen::Success || !block.allFinite())
      return make_issue(IssueCode::compliance_factorisation_failed,
                        "the compliance of a node with itself is not positive definite",
                        "row " + std::to_string(row));
    scaling.scale.push_back(rounded_scale(factor.matrixL()));
  }
  // A symmetric matrix of independent entries e has spectral norm 2 sqrt(3 n) e; half the tolerance is
  // for the shift.
  scaling.entry_error = float(tolerance / (4 * std::sqrt(3.0 * source.node_count())));
  return scaling;
}

NodeScaling frobenius_scaling(const Eigen::VectorXd& norms, double tolerance) {
  const double size = norms.norm() / std::sqrt(double(norms.size()));  // of a column
  NodeScaling scaling;
  const float root = coarse(std::sqrt(size));
  scaling.scale.assign(std::size_t(norms.size() / 3), {root, 0, root, 0, 0, root});
  // Entries of C~ have mean square 1 / (3 n); half the tolerance is for the shift.
  scaling.entry_error = float(0.5 * tolerance / std::sqrt(double(norms.size())));
  return scaling;
}

// Column j of the error is s_j e sqrt(sum_i s_i^2) against s_j^2, smallest where s_j is.
NodeScaling column_scaling(const Eigen::VectorXd& norms, double tolerance) {
  const Eigen::VectorXd roots = norms.cwiseSqrt();
  NodeScaling scaling;
  for (Eigen::Index j = 0; j < roots.size(); j += 3)
    scaling.scale.push_back({coarse(roots[j]), 0, coarse(roots[j + 1]), 0, 0, coarse(roots[j + 2])});
  scaling.entry_error = float(tolerance * roots.minCoeff() / roots.norm());
  return scaling;
}

}  // namespace

std::array<float, 6> rounded_scale(const Eigen::Matrix3d& l) {
  return {coarse(l(0, 0)), coarse(l(1, 0)), coarse(l(1, 1)),
          coarse(l(2, 0)), coarse(l(2, 1)), coarse(l(2, 2))};
}

Eigen::VectorXd column_norms(const SymmetricSource& source, WorkerPool& pool) {
  const Index count = source.node_count();
  std::vector<Index> rows(static_cast<std::size_t>(count));
  std::iota(rows.begin(), rows.end(), Index{0});
  Eigen::VectorXd norms(3 * Eigen::Index{count});
  const std::size_t strips = std::size_t((count + strip_nodes - 1) / strip_nodes);
  pool.run(strips, [&](std::size_t strip, unsigned) {
    const Index first = Index(strip) * strip_nodes, width = std::min(strip_nodes, count - first);
    Eigen::MatrixXf columns(3 * Eigen::Index{count}, 3 * Eigen::Index{width});
    source.read(rows, std::span(rows).subspan(std::size_t(first), std::size_t(width)), columns);
    for (Eigen::Index j = 0; j < columns.cols(); ++j)
      norms[3 * Eigen::Index{first} + j] = std::sqrt(columns.col(j).cast<double>().squaredNorm());
  });
  return norms;
}

Result<NodeScaling> node_scaling(const SymmetricSource& source, const EncodeOptions& options,
                                 WorkerPool& pool) {
  if (options.norm == ErrorNorm::scaled_spectral) return spectral_scaling(source, options.tolerance);
  const Eigen::VectorXd norms = column_norms(source, pool);
  if (!norms.allFinite() || !(norms.minCoeff() > 0))
    return make_issue(IssueCode::compliance_factorisation_failed,
                      "a column of the compliance is zero or not finite");
  return options.norm == ErrorNorm::frobenius ? frobenius_scaling(norms, options.tolerance)
                                              : column_scaling(norms, options.tolerance);
}

}  // namespace souple
