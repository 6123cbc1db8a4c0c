// SPDX-License-Identifier: MIT
#include "runtime/solve/rest_factor.hpp"

#include <cmath>

namespace souple {
namespace {

// D^-1/2 of every node: D the mean of its block's diagonal.
std::vector<double> scale_diagonal(BlockMatrix& a) {
  const BlockPattern& pattern = *a.pattern;
  std::vector<double> scale(pattern.diagonal.size());
  for (std::size_t node = 0; node < scale.size(); ++node)
    scale[node] = 1 / std::sqrt(a.block(pattern.diagonal[node]).trace() / 3);
  for (std::size_t row = 0; row < scale.size(); ++row)
    for (Index b = pattern.row_begin[row]; b < pattern.row_begin[row + 1]; ++b)
      a.block(b) *= scale[row] * scale[std::size_t(pattern.column[std::size_t(b)])];
  return scale;
}

// Rounded to halves, a factor may lose the weak directions of an extreme contrast. What is left of an
// error e after e -= factor^-1 A e, as a share of its energy: power iteration from a fixed start.
double largest_left(const BlockMatrix& a, const HalfFactor& factor) {
  constexpr int iteration_count = 12;
  const Eigen::Index size = 3 * Eigen::Index{a.pattern->node_count()};
  Eigen::VectorXd error = Eigen::VectorXd::Zero(size), force(size);
  for (const Index node : factor.order())
    node_entry(error, node) =
        Vec3(std::sin(0.7 * node), std::cos(1.1 * node), std::sin(1.9 * node + 1));
  std::vector<float> x(factor.size()), work(factor.work_size());
  double left = 0, last = 0;
  for (int k = 0; k <= iteration_count; ++k) {
    multiply(a, error, force);
    const double energy = error.dot(force);
    if (k > 0) left = std::sqrt(energy / last);
    if (!(energy > 0) || left > 1) return left;
    last = energy;
    const double unit = 1 / force.cwiseAbs().maxCoeff();
    for (std::size_t place = 0; place < x.size(); ++place)
      x[place] =
          float(unit * force[3 * Eigen::Index{factor.order()[place / 3]} + Eigen::Index(place % 3)]);
    factor.solve(x.data(), work.data());
    for (std::size_t place = 0; place < x.size(); ++place)
      error[3 * Eigen::Index{factor.order()[place / 3]} + Eigen::Index(place % 3)] -=
          double(x[place]) / unit;
  }
  return left;
}

}  // namespace

Result<RestFactor> RestFactor::create(const CorotationalModel& model, double mass_factor,
                                      double stiffness_factor, std::span<const Index> free_nodes) {
  BlockMatrix a(model.pattern());
  model.assemble_rest(mass_factor, stiffness_factor, a);
  const std::vector<double> scale = scale_diagonal(a);
  RestFactor rest;
  if (!rest.factor_.create(a, model.rest_positions(), free_nodes))
    return make_issue(IssueCode::solver_not_possible,
                      "the matrix of the rest shape is not positive definite; the worst tet is " +
                          std::to_string(model.worst_element()));
  // Beyond a half, conjugate gradients would lose more by its errors than they gain.
  constexpr double most_left = 0.5;
  if (const double left = largest_left(a, rest.factor_); !(left <= most_left))
    return make_issue(IssueCode::solver_not_possible,
                      "in half precision the factor of the rest shape leaves " + std::to_string(left) +
                          " of an error; the worst tet is " + std::to_string(model.worst_element()));
  for (const Index node : rest.factor_.order()) rest.scale_.push_back(float(scale[std::size_t(node)]));
  rest.matrix_bytes_ = a.values.size() * sizeof(a.values[0]);
  return rest;
}

RestFactorPreconditioner::RestFactorPreconditioner(std::shared_ptr<const RestFactor> factor)
    : factor_(std::move(factor)), x_(factor_->factor().size()), work_(factor_->factor().work_size()) {}

double RestFactorPreconditioner::work_units() const {
  return 2 * double(factor_->bytes()) / double(factor_->matrix_bytes());
}

// Brought to unit size first: single precision holds 38 decades, loads of small bodies nearly as many.
void RestFactorPreconditioner::apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) {
  z = r;
  const double size = r.cwiseAbs().maxCoeff();
  if (!(size > 0)) return;
  const std::span<const Index> order = factor_->factor().order();
  const std::span<const float> scale = factor_->scale();
  const double unit = 1 / size;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Vec3 value = (unit * double(scale[k])) * node_entry(r, order[k]);
    for (std::size_t c = 0; c < 3; ++c) x_[3 * k + c] = float(value[Eigen::Index(c)]);
  }
  factor_->factor().solve(x_.data(), work_.data());
  for (std::size_t k = 0; k < order.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c)
      z[3 * Eigen::Index{order[k]} + Eigen::Index(c)] = size * double(scale[k]) * double(x_[3 * k + c]);
}

}  // namespace souple
