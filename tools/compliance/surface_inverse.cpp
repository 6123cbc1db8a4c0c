// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/surface_inverse.hpp"

#include <algorithm>
#include <cmath>

#include "tools/compliance/worker_pool.hpp"

namespace souple {
namespace {

// Right sides of one task of `apply`: wide enough for the products, narrow enough for the memory; few
// right sides are shared out all the same.
constexpr Eigen::Index apply_columns = 16, few_columns = 4;
constexpr double apply_tolerance = 1e-11;
// Conjugate gradients gain about six digits an iteration where single precision fits the matrix.
constexpr int largest_iteration_count = 40;

OrderedMatrix ordered(const BlockMatrix& a, std::span<const Index> nodes,
                      std::span<const std::int64_t> position_of_node) {
  const BlockPattern& pattern = *a.pattern;
  std::vector<std::int64_t> position(std::size_t(pattern.node_count()), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k) position[std::size_t(nodes[k])] = position_of_node[k];
  OrderedMatrix out;
  out.row_begin.push_back(0);
  for (const Index node : nodes) {
    for (Index b = pattern.row_begin[node]; b < pattern.row_begin[node + 1]; ++b) {
      const std::int64_t column = position[std::size_t(pattern.column[b])];
      if (column < 0) continue;
      out.column.push_back(std::int32_t(column));
      const double* block = a.values.data() + 9 * std::size_t(b);
      out.value.insert(out.value.end(), block, block + 9);
    }
    out.row_begin.push_back(std::int64_t(out.column.size()));
  }
  out.row.assign(position_of_node.begin(), position_of_node.end());
  return out;
}

// Relative to 0 where the vector itself is 0.
double ratio(double part, double whole) { return whole > 0 ? std::sqrt(part / whole) : 0; }

}  // namespace

std::size_t OrderedMatrix::bytes() const {
  return value.size() * sizeof(double) + column.size() * sizeof(std::int32_t) +
         (row.size() + row_begin.size()) * sizeof(std::int64_t);
}

void OrderedMatrix::subtract_product(const Eigen::MatrixXd& x, Eigen::MatrixXd& r) const {
  for (std::size_t k = 0; k < row.size(); ++k)
    for (std::int64_t b = row_begin[k]; b < row_begin[k + 1]; ++b) {
      const double* block = value.data() + 9 * b;
      const std::int64_t source = column[std::size_t(b)];
      for (int i = 0; i < 3; ++i)
        r.col(row[k] + i) -= block[3 * i] * x.col(source) + block[3 * i + 1] * x.col(source + 1) +
                             block[3 * i + 2] * x.col(source + 2);
    }
}

Result<std::unique_ptr<SurfaceInverse>> SurfaceInverse::create(const BlockMatrix& a0,
                                                               std::span<const Index> free_nodes,
                                                               std::span<const Index> surface_nodes,
                                                               const Limits& limits) {
  auto factor = SupernodalFactor::create(
      a0, free_nodes,
      {limits.memory_limit_bytes, limits.threads, {}, {}, limits.progress, limits.cancelled});
  if (!factor) return factor.issue();
  const SupernodeView view = factor->view();
  std::unique_ptr<SurfaceInverse> inverse(new SurfaceInverse);
  inverse->peak_bytes_ = factor->bytes() + SingleFactor::bytes_of(view);
  if (inverse->peak_bytes_ > limits.memory_limit_bytes)
    return make_issue(IssueCode::compliance_out_of_memory,
                      "the factor and its copy need " + std::to_string(inverse->peak_bytes_ / 1000000) +
                          " MB, allowed are " + std::to_string(limits.memory_limit_bytes / 1000000) +
                          " MB");
  inverse->matrix_ = ordered(a0, free_nodes, view.position_of_node);
  inverse->threads_ = limits.threads;
  std::vector<std::int64_t> wanted;
  std::size_t local = 0;  // both lists ascend
  for (const Index node : surface_nodes) {
    while (free_nodes[local] != node) ++local;
    inverse->places_.push_back(view.position_of_node[local]);
    for (int c = 0; c < 3; ++c) wanted.push_back(inverse->places_.back() + c);
  }
  inverse->factor_ = std::make_unique<SingleFactor>(view, wanted);
  return inverse;
}

void SurfaceInverse::apply_single(std::span<const std::int64_t> places, FloatRef x_and_y,
                                  Work& work) const {
  work.x.setZero(x_and_y.cols(), factor_->size());
  for (std::size_t node = 0; node < places.size(); ++node)
    work.x.middleCols(places[node], 3) = x_and_y.middleRows(3 * Eigen::Index(node), 3).transpose();
  factor_->solve(work.x, SingleFactor::Reach::wanted, work.scratch);
  for (std::size_t node = 0; node < places.size(); ++node)
    x_and_y.middleRows(3 * Eigen::Index(node), 3) = work.x.middleCols(places[node], 3).transpose();
}

void SurfaceInverse::precondition(const Eigen::MatrixXd& residual, Eigen::MatrixXd& out,
                                  Work& work) const {
  // To the size of 1, so that small residuals do not vanish in single precision.
  Eigen::VectorXd size = residual.cwiseAbs().rowwise().maxCoeff();
  for (double& value : size)
    if (!(value > 0)) value = 1;
  work.x = (size.cwiseInverse().asDiagonal() * residual).cast<float>();
  factor_->solve(work.x, SingleFactor::Reach::everything, work.scratch);
  out = size.asDiagonal() * work.x.cast<double>();
}

double SurfaceInverse::apply_refined(std::span<const std::int64_t> places,
                                     Eigen::Ref<Eigen::MatrixXd> x_and_y, double tolerance,
                                     Work& work) const {
  const Eigen::Index k = x_and_y.cols(), size = factor_->size();
  Eigen::MatrixXd &x = work.solution, &r = work.residual, &p = work.direction, &z = work.product;
  x.setZero(k, size);
  r.setZero(k, size);
  for (std::size_t node = 0; node < places.size(); ++node)
    r.middleCols(places[node], 3) = x_and_y.middleRows(3 * Eigen::Index(node), 3).transpose();
  // With A / unit, whose inverse the factor gives.
  r /= factor_->unit();
  const Eigen::VectorXd right_side = r.rowwise().squaredNorm();
  Eigen::VectorXd old_product = Eigen::VectorXd::Zero(k);
  p.setZero(k, size);
  double worst = 0;
  for (int iteration = 0; iteration < largest_iteration_count; ++iteration) {
    const Eigen::VectorXd left = r.rowwise().squaredNorm();
    worst = 0;
    for (Eigen::Index c = 0; c < k; ++c) worst = std::max(worst, ratio(left[c], right_side[c]));
    if (!(worst > tolerance)) break;
    precondition(r, z, work);
    const Eigen::VectorXd product = (r.cwiseProduct(z)).rowwise().sum();
    Eigen::VectorXd beta(k), alpha(k);
    for (Eigen::Index c = 0; c < k; ++c) beta[c] = old_product[c] > 0 ? product[c] / old_product[c] : 0;
    p = (beta.asDiagonal() * p + z).eval();
    old_product = product;
    z.setZero();
    matrix_.subtract_product(p, z);
    z /= -factor_->unit();
    const Eigen::VectorXd curvature = (p.cwiseProduct(z)).rowwise().sum();
    for (Eigen::Index c = 0; c < k; ++c) alpha[c] = curvature[c] > 0 ? product[c] / curvature[c] : 0;
    x.noalias() += alpha.asDiagonal() * p;
    r.noalias() -= alpha.asDiagonal() * z;
  }
  for (std::size_t node = 0; node < places.size(); ++node)
    x_and_y.middleRows(3 * Eigen::Index(node), 3) = x.middleCols(places[node], 3).transpose();
  return worst;
}

Eigen::MatrixXd SurfaceInverse::solution_on_free_nodes(const Work& work) const {
  Eigen::MatrixXd u(work.solution.cols(), work.solution.rows());
  for (std::size_t node = 0; node < matrix_.row.size(); ++node)
    u.middleRows(3 * Eigen::Index(node), 3) =
        work.solution.middleCols(matrix_.row[node], 3).transpose();
  return u;
}

void SurfaceInverse::apply(const Eigen::Ref<const Eigen::MatrixXd>& x,
                           Eigen::Ref<Eigen::MatrixXd> y) const {
  const Eigen::Index width = x.cols() > apply_columns ? apply_columns : few_columns;
  const Eigen::Index tasks = (x.cols() + width - 1) / width;
  WorkerPool pool(threads_);
  std::vector<Work> work(pool.threads());
  pool.run(std::size_t(tasks), [&](std::size_t task, unsigned worker) {
    const Eigen::Index begin = Eigen::Index(task) * width;
    const Eigen::Index count = std::min(width, x.cols() - begin);
    Eigen::MatrixXd part = x.middleCols(begin, count);
    apply_refined(places_, part, apply_tolerance, work[worker]);
    y.middleCols(begin, count) = part;
  });
}

double SurfaceInverse::least_share(std::span<const Eigen::Matrix3d> scales) const {
  std::vector<const Eigen::Matrix3d*> scale_at(std::size_t(factor_->size()), nullptr);
  for (std::size_t row = 0; row < places_.size(); ++row)
    scale_at[std::size_t(places_[row])] = &scales[row];
  double largest = 0;  // of the rows of S^T A S, no less than its largest eigenvalue
  for (std::size_t k = 0; k < matrix_.row.size(); ++k) {
    const Eigen::Matrix3d* own = scale_at[std::size_t(matrix_.row[k])];
    if (!own) continue;
    double sum = 0;
    for (std::int64_t b = matrix_.row_begin[k]; b < matrix_.row_begin[k + 1]; ++b) {
      const Eigen::Matrix3d* other = scale_at[std::size_t(matrix_.column[std::size_t(b)])];
      if (!other) continue;
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(matrix_.value.data() +
                                                                                 9 * b);
      sum += (own->transpose() * block * *other).norm();
    }
    largest = std::max(largest, sum);
  }
  return largest > 0 && std::isfinite(largest) ? 1 / largest : 0;
}

}  // namespace souple
