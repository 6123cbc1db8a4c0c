// SPDX-License-Identifier: MIT
#include "runtime/world/explicit_limit.hpp"

#include <cmath>

namespace souple {
namespace {

// Largest eigenvalue of M^-1 K, 1/s^2, by power iteration until it grows by less than 1e-5 a step;
// the margin covers what it still misses.
double largest_squared_frequency(const CorotationalModel& model) {
  constexpr int max_iterations = 2000;
  constexpr double growth = 1e-5, margin = 1.02;
  BlockMatrix stiffness(model.pattern());
  model.assemble_rest(0, 1, stiffness);
  const Eigen::Index size = 3 * Eigen::Index{model.node_count()};
  Eigen::VectorXd mode(size), product(size);
  for (Eigen::Index k = 0; k < size; ++k) mode[k] = k % 2 == 0 ? 1 + 1e-3 * double(k % 17) : -1;
  double value = 0;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    mode.normalize();
    multiply(stiffness, mode, product);
    for (Index node = 0; node < model.node_count(); ++node)
      node_entry(product, node) /= model.masses()[std::size_t(node)];
    const double last = value;
    value = product.norm();
    if (value - last <= growth * value && iteration > 20) break;
    mode.swap(product);
  }
  return margin * value;
}

}  // namespace

double explicit_step_limit(const CorotationalModel& model) {
  const double w2 = largest_squared_frequency(model);
  const double damping = model.rayleigh_mass_per_s() + model.rayleigh_stiffness_s() * w2;
  return (std::sqrt(damping * damping + 4 * w2) - damping) / w2;
}

}  // namespace souple
