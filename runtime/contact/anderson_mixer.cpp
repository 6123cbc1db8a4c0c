// SPDX-License-Identifier: MIT
#include "runtime/contact/anderson_mixer.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>

namespace souple {

void AndersonMixer::restart() {
  count_ = next_ = 0;
  has_last_ = false;
}

double AndersonMixer::product(int a, std::span<const double> residual) const {
  return std::inner_product(residual.begin(), residual.end(), residual_change_[a].begin(), 0.0);
}

void AndersonMixer::remember(std::span<const double> residual, std::span<const double> after) {
  if (has_last_) {
    std::vector<double>&df = residual_change_[next_], &dg = after_change_[next_];
    df.resize(residual.size());
    dg.resize(after.size());
    std::ranges::transform(residual, last_residual_, df.begin(), std::minus());
    std::ranges::transform(after, last_after_, dg.begin(), std::minus());
    count_ = std::min(count_ + 1, history);
    for (int a = 0; a < count_; ++a) gram_(a, next_) = gram_(next_, a) = product(a, df);
    next_ = (next_ + 1) % history;
  }
  last_residual_.assign(residual.begin(), residual.end());
  last_after_.assign(after.begin(), after.end());
  has_last_ = true;
}

void AndersonMixer::mix(std::span<const double> before, std::span<double> after) {
  constexpr double regularisation = 1e-12;  // of the trace: the changes are often nearly dependent
  residual_.resize(after.size());
  std::ranges::transform(after, before, residual_.begin(), std::minus());
  remember(residual_, after);
  if (count_ == 0) return;
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, history, history>;
  Small gram = gram_.topLeftCorner(count_, count_);
  gram.diagonal().array() += regularisation * gram.trace();
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, history, 1> weight(count_);
  for (int a = 0; a < count_; ++a) weight[a] = product(a, residual_);
  const Eigen::LDLT<Small> factor(gram);
  weight = factor.solve(weight).eval();
  if (!weight.allFinite()) return restart();
  for (int a = 0; a < count_; ++a)
    for (std::size_t k = 0; k < after.size(); ++k) after[k] -= weight[a] * after_change_[a][k];
}

}  // namespace souple
