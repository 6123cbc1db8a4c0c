// SPDX-License-Identifier: MIT
// Plain parameters of a haptic channel: no behaviour, defaults that work, SI units.
#pragma once
#include <cstddef>

#include "runtime/haptics/device.hpp"

namespace souple {

struct HapticSettings {
  /// A problem may hold so many contacts; of more the most loaded are taken. 1 to 4096.
  std::size_t contact_capacity = 256;
  /// Wall time in which a tick begins no further sweep, s; infinite: only `max_sweeps` ends it.
  double tick_budget_s = 0.0008;
  /// A tick is content with this residual of the laws (natural map over the norm of the forces).
  double residual_goal = 3e-4;
  int max_sweeps = 1000;  ///< of one tick
  /// How long the difference between the force before a publication and that of the new problem fades,
  /// s; 0: the time between the last two publications.
  double hand_over_s = 0;
  /// It fades sooner where it can by steps of this share of the largest force of the last seconds.
  double hand_over_share = 0.02;
  /// Physics that has published nothing for so long is taken for dead; its force then fades, s.
  double dead_after_s = 0.3;
  double fade_s = 0.2;  ///< from full force to none, and back, s
  /// No hand is faster: a sample that asks for more is refused.
  double credible_speed_m_s = 10;
  double credible_turn_rad_s = 100;
  /// A device that keeps to an incredible place (it was switched off and on) is believed after so
  /// long, with a force that comes up from zero, s.
  double recover_after_s = 0.1;
  /// How far a contact point may be taken from where physics had it, m: beyond, the linear problem says
  /// nothing, and the force stays what it is there.
  double reach_m = 0.01;
  /// Ticks look for the force where the handle will be so much later, by its motion of late, s. What a
  /// device and its loop are late by, half a tick for the force that is held until the next one
  /// included: contacts may then be stiffer before a hand on them shakes. 0 to 0.02.
  double lead_s = 0;
  DeviceLimits limits;  ///< of the device; applied last
};

}  // namespace souple
