// SPDX-License-Identifier: MIT
#pragma once
#include "runtime/fem/corotational_model.hpp"

namespace souple {

/// The longest stable step of explicit Euler, s: the positive root of h^2 w^2 + 2 h (alpha + beta w^2)
/// = 4, from the amplification matrix of an oscillator of frequency w with damping alpha + beta w^2. w
/// is the highest frequency of the free body at rest; holding nodes only lowers it. Offline: it
/// allocates.
double explicit_step_limit(const CorotationalModel& model);

}  // namespace souple
