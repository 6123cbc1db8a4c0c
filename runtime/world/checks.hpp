// SPDX-License-Identifier: MIT
// What enters a world is checked and placed here. Internal to the world.
#pragma once
#include "formats/core/result.hpp"
#include "runtime/world/bodies.hpp"
#include "runtime/world/settings.hpp"

namespace souple {

/// All with issue world_parameter_invalid, naming the value.
Status check_settings(const WorldSettings& settings);
Status check_soft_body(const SoftBodyDescription& description);
Status check_rigid_body(const RigidBodyDescription& description);
Status check_pair(const PairRule& rule, const std::string& where);

/// Marks the fixed nodes; an empty name fixes none. Issue fixed_set_invalid.
Status hold_fixed_set(SoftBody& body, const std::string& fixed_set);
/// Issue driven_nodes_invalid.
Status drive_nodes(SoftBody& body, const SoftBodyDescription& description);
/// What the integrator asks of the body, and its memory.
/// Issues: static_body_not_held, explicit_step_too_long.
Status prepare_integrator(SoftBody& body, const WorldSettings& settings);
/// Chooses the compliance, or prepares the factor of the exact method, and the work space.
/// Issue scene_no_matching_compliance, listing what the asset has.
Status prepare_contact_method(SoftBody& body, const WorldSettings& settings,
                              const std::string& fixed_set);
/// Positions and velocities of the rest shape under the description's pose and rigid velocity; driven
/// nodes where their path is at `time_s`.
void place_soft_body(SoftBody& body, const SoftBodyDescription& description, double time_s);

}  // namespace souple
