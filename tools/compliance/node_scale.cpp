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
  // A symmetric matrix of independent entries e has spectral norm 2 sqrt(3 n) e.
  scaling.entry_error = float(tolerance / (2 * std::sqrt(3.0 * source.node_count())));
  return scaling;
}

NodeScaling frobenius_scaling(const Eigen::VectorXd& norms, double tolerance) {
  const double size = norms.norm() / std::sqrt(double(norms.size()));  // of a column
  NodeScaling scaling;
  const float root = coarse(std::sqrt(size));
  scaling.scale.assign(std::size_t(norms.size() / 3), {root, 0, root, 0, 0, root});
  // Entries of C~ have mean square 1 / (3 n).
  scaling.entry_error = float(tolerance / std::sqrt(double(norms.size())));
  return scaling;
}

// With entries' errors s_i s_j e, column j of the error is s_j |s| e against norm c_j. Bits are fewest,
// -sum log(s_i s_j e), where s_j = min(c_j, cap): all columns err alike but the largest, which do not
// use their share, because a smaller |s| is worth more to the others. The cap is sqrt(2) times the root
// mean square of s (Lagrange); a little less left more room for staying positive definite.
Eigen::VectorXd capped(const Eigen::VectorXd& norms) {
  constexpr double share = 1.3;
  constexpr int rounds = 60;
  Eigen::VectorXd s = norms;
  for (int k = 0; k < rounds; ++k) s = norms.cwiseMin(share * s.norm() / std::sqrt(double(s.size())));
  return s;
}

NodeScaling column_scaling(const Eigen::VectorXd& norms, double tolerance) {
  const double unit = std::sqrt(norms.mean());
  const Eigen::VectorXd s = capped(norms) / unit;
  NodeScaling scaling;
  for (Eigen::Index j = 0; j < s.size(); j += 3)
    scaling.scale.push_back({coarse(s[j]), 0, coarse(s[j + 1]), 0, 0, coarse(s[j + 2])});
  scaling.entry_error = float(tolerance * unit / s.norm());
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
