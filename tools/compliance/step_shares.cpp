// SPDX-License-Identifier: GPL-3.0-or-later
// How fine every block is quantised. With S the scaling and q_b the step of block b, a coefficient's
// error is uniform with variance q_b^2 / 12, and entry (i, j) of C gets the variance
//   s_i^2 s_j^2 q_b^2 / 12 (h_i + g_j),   h_i = sum_k u_ik^2, g_j = sum_k v_jk^2 over the terms that
//   are
// not all zero; in a leaf h_i + g_j = 1. Bits are -sum_b N_b log q_b, N_b the coefficients of b. The
// least bits under a bound of every column's relative error have multipliers m_j >= 0 of the columns
// with
//   q_b^2 = N_b / sum_j m_j w_bj,   w_bj = what one q_b^2 adds to the squared relative error of column
//   j,
// found by raising m_j where column j errs most.
#include <algorithm>
#include <cmath>

#include "tools/compliance/node_scale.hpp"
#include "tools/compliance/quantised_matrix.hpp"

namespace souple {
namespace {

using Eigen::VectorXd;

constexpr int multiplier_steps = 200;

/// Squared relative errors that a step of 1 in one block gives to a range of columns.
struct Influence {
  Eigen::Index begin = 0;
  VectorXd weight;
};

struct Part {
  double coefficients = 0;
  Influence first, second;  ///< a leaf has only the first
};

struct Column {
  VectorXd size2;      ///< s_j^2: squared row j of S
  VectorXd relative2;  ///< s_j^2 / |C e_j|^2
};

Column columns_of(const HodlrMatrix& matrix, const VectorXd& norms) {
  Column column{VectorXd(norms.size()), VectorXd(norms.size())};
  for (std::size_t p = 0; p < matrix.order.size(); ++p) {
    const auto l = scale_matrix<double>(matrix.scale[std::size_t(matrix.order[p])]);
    column.size2.segment<3>(3 * Eigen::Index(p)) = l.rowwise().squaredNorm();
  }
  column.relative2 = column.size2.cwiseQuotient(norms.cwiseAbs2().cwiseMax(1e-300));
  return column;
}

Part block_part(const LowRankBlock& block, Eigen::Index begin, const Column& column) {
  const Eigen::Index rows = block.left.rows(), columns = block.right.rows();
  const VectorXd h = block.left.cast<double>().rowwise().squaredNorm();
  const VectorXd g = block.right.cast<double>().rowwise().squaredNorm();
  const VectorXd si = column.size2.segment(begin, rows),
                 sj = column.size2.segment(begin + rows, columns);
  Part part;
  part.coefficients = double(block.singular.size()) * double(rows + columns);
  part.first = {begin,
                column.relative2.segment(begin, rows).array() * (sj.dot(g) + sj.sum() * h.array())};
  part.second = {begin + rows, column.relative2.segment(begin + rows, columns).array() *
                                   (si.dot(h) + si.sum() * g.array())};
  return part;
}

std::vector<Part> parts_of(const HodlrMatrix& matrix, const VectorXd& norms) {
  const Column column = columns_of(matrix, norms);
  const auto count = Index(matrix.order.size());
  std::vector<Part> parts;
  for (int d = 0; d < matrix.depth; ++d)
    for (Index i = 0; i < (Index{1} << d); ++i)
      parts.push_back(block_part(matrix.blocks[std::size_t(block_of_cluster(d, i))],
                                 3 * Eigen::Index{cluster_range(count, d, i).begin}, column));
  for (Index leaf = 0; leaf < (Index{1} << matrix.depth); ++leaf) {
    const ClusterRange range = cluster_range(count, matrix.depth, leaf);
    const Eigen::Index begin = 3 * Eigen::Index{range.begin}, rows = 3 * Eigen::Index{range.size()};
    Part part;
    part.coefficients = 0.5 * double(rows) * double(rows + 1);
    part.first = {begin,
                  column.relative2.segment(begin, rows) * column.size2.segment(begin, rows).sum()};
    parts.push_back(std::move(part));
  }
  return parts;
}

double weighted(const Influence& influence, const VectorXd& multiplier) {
  return influence.weight.dot(multiplier.segment(influence.begin, influence.weight.size()));
}

void add(const Influence& influence, double step2, VectorXd& error2) {
  error2.segment(influence.begin, influence.weight.size()) += step2 * influence.weight;
}

// Squared steps, up to a common factor.
VectorXd balanced_steps(const std::vector<Part>& parts, Eigen::Index column_count) {
  VectorXd multiplier = VectorXd::Ones(column_count), step2(Eigen::Index(parts.size()));
  for (int round = 0; round < multiplier_steps; ++round) {
    VectorXd error2 = VectorXd::Zero(column_count);
    for (std::size_t b = 0; b < parts.size(); ++b) {
      const Part& part = parts[b];
      const double price = weighted(part.first, multiplier) + weighted(part.second, multiplier);
      double& own = step2[Eigen::Index(b)];
      own = std::max(part.coefficients, 1.0) / std::max(price, 1e-300);
      add(part.first, own, error2);
      add(part.second, own, error2);
    }
    multiplier = multiplier.cwiseProduct((error2 / error2.maxCoeff()).cwiseSqrt());
    multiplier = (multiplier / multiplier.mean()).cwiseMax(1e-12);
  }
  return step2;
}

}  // namespace

StepShares step_shares(const HodlrMatrix& matrix, const VectorXd& column_norms, ErrorNorm norm) {
  const auto blocks = Eigen::Index(matrix.blocks.size()), leaves = Eigen::Index(matrix.leaves.size());
  if (norm != ErrorNorm::worst_column) return {VectorXd::Ones(blocks), VectorXd::Ones(leaves)};
  const VectorXd steps =
      balanced_steps(parts_of(matrix, column_norms), column_norms.size()).cwiseSqrt();
  const VectorXd shares = steps / steps.mean();
  return {shares.head(blocks), shares.tail(leaves)};
}

}  // namespace souple
