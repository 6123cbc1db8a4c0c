// SPDX-License-Identifier: GPL-3.0-or-later
// One tool on a hand, with the three couplings that are compared: physics steps at its rate, ticks at
// theirs, on one simulated clock.
#pragma once
#include "runtime/haptics/haptic_channel.hpp"
#include "runtime/world/tool_problem.hpp"

namespace souple::bench {

enum class Coupling {
  virtual_coupling,  ///< a spring from the device to the tool where the last step left it (Colgate
                     ///< 1995)
  god_object,      ///< to a proxy that the planes of the last step keep out (Zilles and Salisbury 1995)
  contact_problem  ///< the contact problem solved anew at the pose of the tick
};
const char* coupling_name(Coupling coupling);

/// A ball on a hand. All three couplings have the same spring and the same world.
class HapticRig {
 public:
  /// `world` has its other bodies.
  static HapticRig make(World world, const Point& at, double radius_m, double stiffness_n_m,
                        double tick_s);

  void physics_step();
  Wrench tick(Coupling coupling, const DeviceSample& sample);
  const World& world() const { return world_; }
  double largest_residual() const { return channel_.residual(); }

 private:
  HapticRig(World world, HapticChannel channel, double stiffness_n_m);
  Vec3 god_object(const Vec3& device) const;

  World world_;
  HapticChannel channel_;
  ToolProblem problem_;  ///< of the last step, for the god object
  double stiffness_;
};

}  // namespace souple::bench
