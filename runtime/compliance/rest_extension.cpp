// SPDX-License-Identifier: MIT
#include "runtime/compliance/rest_extension.hpp"

#include "runtime/fem/sparse_factor.hpp"

namespace souple {

struct RestExtension::State {
  std::vector<Index> inner;      ///< the nodes to fill, in the factor's order of elimination
  std::vector<Index> row_begin;  ///< blocks of A0_is by inner node
  std::vector<Index> held_node;
  std::vector<BlockMatrix::Block> blocks;
  SparseFactor factor;  ///< of A0_ii
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
  auto state = std::make_unique<State>();
  for (Index node = 0; node < model.node_count(); ++node)
    if (roles[node] == Role::inner) state->inner.push_back(node);

  BlockMatrix a0(model.pattern());
  model.assemble_rest(mass_factor, stiffness_factor, a0);
  state->row_begin.push_back(0);
  for (const Index node : state->inner) {
    for (Index b = a0.pattern->row_begin[node]; b < a0.pattern->row_begin[node + 1]; ++b)
      if (roles[a0.pattern->column[b]] == Role::held) {
        state->held_node.push_back(a0.pattern->column[b]);
        state->blocks.push_back(a0.block(b));
      }
    state->row_begin.push_back(static_cast<Index>(state->blocks.size()));
  }
  state->factor.analyze(a0.pattern, state->inner);
  if (!state->factor.factorize(a0))
    return make_issue(IssueCode::compliance_factorisation_failed,
                      "the interior of the rest matrix is not positive definite",
                      "worst element " + std::to_string(model.worst_element()));
  return RestExtension(std::move(state));
}

Eigen::Index RestExtension::work_size() const { return 2 * state_->factor.size(); }

void RestExtension::apply(Eigen::VectorXd& u, Eigen::VectorXd& work) const {
  const State& s = *state_;
  const Eigen::Index size = s.factor.size();
  for (std::size_t k = 0; k < s.inner.size(); ++k) {
    Vec3 load = Vec3::Zero();
    for (Index b = s.row_begin[k]; b < s.row_begin[k + 1]; ++b)
      load.noalias() -= s.blocks[b] * node_entry(u, s.held_node[b]);
    work.segment<3>(3 * Eigen::Index(k)) = load;
  }
  s.factor.solve(work.head(size), work.segment(size, size));
  for (std::size_t k = 0; k < s.inner.size(); ++k)
    node_entry(u, s.inner[k]) = work.segment<3>(3 * Eigen::Index(k));
}

std::size_t RestExtension::resident_bytes() const {
  return state_->factor.bytes() + state_->blocks.size() * (sizeof(BlockMatrix::Block) + sizeof(Index)) +
         (state_->inner.size() + state_->row_begin.size()) * sizeof(Index);
}

}  // namespace souple
