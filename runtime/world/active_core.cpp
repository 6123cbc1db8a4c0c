// SPDX-License-Identifier: MIT
#include "runtime/world/active_core.hpp"

namespace souple {

void ActiveCore::choose(const IslandOperator& island, std::span<const ConstraintLaw> laws,
                        std::span<const double> force) {
  members_.clear();
  contacts_.clear();
  laws_.clear();
  force_.clear();
  gap_.clear();
  for (std::size_t i = 0; i < island.size(); ++i) {
    const Vec3 gap = island.gap(i);
    const bool bears = force[3 * i] != 0 || laws[i].kind == ConstraintLaw::Kind::bilateral;
    if (!bears && gap[0] >= 0) continue;
    members_.push_back(std::uint32_t(i));
    contacts_.push_back(island.contact(i));
    laws_.push_back(laws[i]);
    for (std::size_t r = 0; r < 3; ++r) {
      force_.push_back(force[3 * i + r]);
      gap_.push_back(gap[Eigen::Index(r)]);
    }
  }
}

bool ActiveCore::take(const IslandOperator& island, std::span<const ConstraintLaw> laws,
                      std::span<const double> force) {
  // A sweep over all touches so many rows for one over the core; what it takes to gather the core is
  // that of a few sweeps.
  constexpr double worth_it = 2;
  choose(island, laws, force);
  if (members_.empty()) return false;
  double touched = 0;
  for (const std::uint32_t contact : contacts_) touched += double(island.step().rows_touched(contact));
  const auto rows = double(force_.size());
  if (touched / double(members_.size()) < worth_it * rows) return false;
  rows_.reset(gap_);
  island.step().gather(contacts_, rows_.columns(), gather_);
  rows_.anchor(force_, gap_);
  return true;
}

void ActiveCore::give_back(std::span<double> force) const {
  for (std::size_t k = 0; k < members_.size(); ++k)
    for (std::size_t r = 0; r < 3; ++r) force[3 * std::size_t(members_[k]) + r] = force_[3 * k + r];
}

}  // namespace souple
