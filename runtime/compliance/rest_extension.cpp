// SPDX-License-Identifier: MIT
#include "runtime/compliance/rest_extension.hpp"

#include <array>

#include "runtime/fem/half_factor.hpp"

namespace souple {

struct RestExtension::State {
  HalfFactor factor;                         ///< of A0_ii; its order is that of the inner nodes here
  std::vector<Index> row_begin;              ///< blocks of A0_is by inner node
  std::vector<Index> held_node;              ///< of every block
  std::vector<std::array<float, 9>> blocks;  ///< row-major
};

namespace {

enum class Role : std::uint8_t { inner, held, fixed };

std::vector<Role> node_roles(Index node_count, std::span<const Index> held,
                             std::span<const Index> fixed) {
  std::vector<Role> roles(node_count, Role::inner);
  for (const Index node : held) roles[node] = Role::held;
  for (const Index node : fixed) roles[node] = Role::fixed;
  return roles;
}

}  // namespace

RestExtension::RestExtension(std::unique_ptr<State> state) : state_(std::move(state)) {}
RestExtension::RestExtension(RestExtension&&) noexcept = default;
RestExtension& RestExtension::operator=(RestExtension&&) noexcept = default;
RestExtension::~RestExtension() = default;

Result<RestExtension> RestExtension::create(const CorotationalModel& model, double mass_factor,
                                            double stiffness_factor, std::span<const Index> held,
                                            std::span<const Index> fixed) {
  const auto roles = node_roles(model.node_count(), held, fixed);
  std::vector<Index> inner;
  for (Index node = 0; node < model.node_count(); ++node)
    if (roles[node] == Role::inner) inner.push_back(node);

  BlockMatrix a0(model.pattern());
  model.assemble_rest(mass_factor, stiffness_factor, a0);
  auto state = std::make_unique<State>();
  if (!state->factor.create(a0, model.rest_positions(), inner))
    return make_issue(IssueCode::compliance_factorisation_failed,
                      "the interior of the rest matrix is not positive definite",
                      "worst element " + std::to_string(model.worst_element()));
  state->row_begin.push_back(0);
  for (const Index node : state->factor.order()) {
    for (Index b = a0.pattern->row_begin[node]; b < a0.pattern->row_begin[node + 1]; ++b)
      if (roles[a0.pattern->column[b]] == Role::held) {
        state->held_node.push_back(a0.pattern->column[b]);
        std::array<float, 9>& block = state->blocks.emplace_back();
        for (std::size_t k = 0; k < 9; ++k) block[k] = float(a0.values[9 * std::size_t(b) + k]);
      }
    state->row_begin.push_back(static_cast<Index>(state->blocks.size()));
  }
  return RestExtension(std::move(state));
}

std::size_t RestExtension::work_size() const {
  return state_->factor.size() + state_->factor.work_size();
}

void RestExtension::apply(Eigen::VectorXd& u, std::span<float> work) const {
  const State& s = *state_;
  const std::span<const Index> inner = s.factor.order();
  float* x = work.data();
  for (std::size_t k = 0; k < inner.size(); ++k) {
    float load[3] = {};
    for (Index b = s.row_begin[k]; b < s.row_begin[k + 1]; ++b) {
      const double* held = u.data() + 3 * std::size_t(s.held_node[b]);
      const float m[3] = {float(held[0]), float(held[1]), float(held[2])};
      const std::array<float, 9>& block = s.blocks[b];
      for (std::size_t i = 0; i < 3; ++i)
        load[i] -= block[3 * i] * m[0] + block[3 * i + 1] * m[1] + block[3 * i + 2] * m[2];
    }
    for (std::size_t i = 0; i < 3; ++i) x[3 * k + i] = load[i];
  }
  s.factor.solve(x, x + s.factor.size());
  for (std::size_t k = 0; k < inner.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) u[3 * Eigen::Index{inner[k]} + Eigen::Index(i)] = x[3 * k + i];
}

std::size_t RestExtension::resident_bytes() const {
  return state_->factor.bytes() + state_->blocks.size() * (sizeof(state_->blocks[0]) + sizeof(Index)) +
         state_->row_begin.size() * sizeof(Index);
}

}  // namespace souple
