// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/haptics/devices/held_mass.hpp"
#include "runtime/haptics/devices/recorded_path.hpp"

namespace souple {

/// A hand on a device: masses of both, the device's damping, the hand's spring and damper.
struct HandModel {
  HeldMass move;     ///< each axis alike
  HeldMass turn;     ///< about the handle's origin, each axis alike
  HeldMass opening;  ///< of the jaws
};

/// A stylus of 80 g (as an impedance device of desktop size presents it) in a hand whose grip goes from
/// 0, limp, to 1, stiff: spring 20 to 1500 N/m, evenly in the logarithm, damping at 0.3 of the
/// critical. The range is that of grasped styli and fingertips (Hajian and Howe 1997; Kuchenbecker,
/// Park and Niemeyer 2003).
HandModel hand_of_grip(double grip);

struct SyntheticHandSettings {
  HandModel model = hand_of_grip(0.5);
  DeviceLimits limits;
  double resolution_m = 0;         ///< of the encoders; 0: exact
  double turn_resolution_rad = 0;  ///< of each component of the turn since the start
  double opening_resolution_rad = 0;
  std::size_t delay_samples = 0;  ///< ticks by which what is read is older than the force it meets
};

/// A hand that wants to follow a path and gives way to the wrench. Its clock goes on by a tick with
/// every `write`, the wrench being constant for that time: exactly discretised in place and opening,
/// and in turns about one axis (others within a tick as if about one).
class SyntheticHand final : public HapticDevice {
 public:
  static constexpr std::size_t delay_limit = 1000;

  /// At rest where the path begins. Issue world_parameter_invalid.
  static Result<SyntheticHand> create(RecordedPath wish, const SyntheticHandSettings& settings);

  DeviceLimits limits() const override { return settings_.limits; }
  bool read(DeviceSample& sample) override;
  /// A wrench that is not finite counts as none; beyond the limits it is cut, as by a motor.
  void write(const Wrench& wrench) override;

  /// Without encoders and delay.
  const DeviceSample& truth() const { return truth_; }
  const Vec3& velocity_m_s() const { return velocity_; }
  /// What all wrenches so far have given to the hand, J; of a passive world never above zero.
  double received_j() const { return received_j_; }
  std::uint64_t refused_wrenches() const { return refused_wrenches_; }

 private:
  SyntheticHand(RecordedPath wish, const SyntheticHandSettings& settings, const HeldMassStep& move,
                const HeldMassStep& turn, const HeldMassStep& opening);
  Wrench by_motor(const Wrench& wrench);
  DeviceSample measured() const;
  void advance_place(const DeviceSample& from, const DeviceSample& to, double tick_s,
                     const Vec3& force);
  void advance_turn(const DeviceSample& from, const DeviceSample& to, double tick_s,
                    const Vec3& torque);
  void advance_opening(const DeviceSample& from, const DeviceSample& to, double tick_s, double torque);

  RecordedPath wish_;
  SyntheticHandSettings settings_;
  HeldMassStep move_, turn_, opening_;
  DeviceSample truth_;
  Pose start_;
  Vec3 velocity_ = Vec3::Zero(), spin_ = Vec3::Zero();
  double opening_rate_ = 0;
  std::vector<DeviceSample> measured_;  ///< ring of the delay
  std::uint64_t ticks_ = 0;
  bool has_new_ = true;
  double received_j_ = 0;
  std::uint64_t refused_wrenches_ = 0;
};

}  // namespace souple
