// SPDX-License-Identifier: MIT
#include "runtime/collision/proximity_work.hpp"

#include "runtime/collision/proximity_arrays.hpp"

namespace souple {

ProximityWork::ProximityWork() : arrays_(std::make_unique<Arrays>()) {}
ProximityWork::~ProximityWork() = default;
ProximityWork::ProximityWork(ProximityWork&&) noexcept = default;
ProximityWork& ProximityWork::operator=(ProximityWork&&) noexcept = default;

}  // namespace souple
