/* SPDX-License-Identifier: MIT */
#include "c_program.h"

static souple_status add_bodies(souple_world* world, const souple_asset* asset, souple_body* body) {
  souple_soft_body_description soft;
  souple_rigid_body_description plane;
  souple_status status = souple_soft_body_description_init(&soft, sizeof soft);
  if (status == SOUPLE_OK) status = souple_rigid_body_description_init(&plane, sizeof plane);
  if (status != SOUPLE_OK) return status;
  soft.name = "dropped";
  soft.pose.rotation_wxyz[0] = 0.8;
  soft.pose.rotation_wxyz[1] = 0.6;
  soft.pose.translation_m.z = 0.1;
  soft.velocity_m_s.x = 0.3;
  plane.name = "floor";
  status = souple_world_add_soft_body(world, asset, &soft, body);
  if (status == SOUPLE_OK) {
    souple_body floor_body;
    status = souple_world_add_rigid_body(world, &plane, &floor_body);
  }
  return status;
}

static souple_status run(souple_world* world, const souple_asset* asset, int steps,
                         souple_vec3* positions_m, size_t* count) {
  souple_body body = SOUPLE_NO_BODY;
  souple_status status = add_bodies(world, asset, &body);
  for (int k = 0; status == SOUPLE_OK && k < steps; ++k) status = souple_world_step(world, NULL);
  if (status == SOUPLE_OK) status = souple_world_positions(world, body, positions_m, *count, count);
  return status;
}

souple_status c_drop(const char* asset_file, int steps, souple_vec3* positions_m, size_t* count) {
  souple_asset* asset = NULL;
  souple_world* world = NULL;
  souple_status status = SOUPLE_CHECK_ABI();
  if (status == SOUPLE_OK) status = souple_asset_open_file(asset_file, NULL, &asset);
  if (status == SOUPLE_OK) status = souple_world_create(NULL, &world);
  if (status == SOUPLE_OK) status = run(world, asset, steps, positions_m, count);
  souple_world_destroy(world);
  souple_asset_release(asset);
  return status;
}

#define SIZE(type) \
  { #type, sizeof(type) }

const c_struct_size* c_struct_sizes(void) {
  static const c_struct_size sizes[] = {
      SIZE(souple_vec3),
      SIZE(souple_triangle),
      SIZE(souple_pose),
      SIZE(souple_keyframe),
      SIZE(souple_load_options),
      SIZE(souple_asset_facts),
      SIZE(souple_compliance_facts),
      SIZE(souple_world_settings),
      SIZE(souple_driven_set),
      SIZE(souple_soft_body_description),
      SIZE(souple_rigid_body_description),
      SIZE(souple_load_keyframe),
      SIZE(souple_load_description),
      SIZE(souple_joint_description),
      SIZE(souple_pick_hit),
      SIZE(souple_step_report),
      SIZE(souple_contact),
      SIZE(souple_contact_event),
      SIZE(souple_jaw_description),
      SIZE(souple_tool_description),
      SIZE(souple_haptic_settings),
      SIZE(souple_device_sample),
      SIZE(souple_wrench),
      SIZE(souple_histogram),
      SIZE(souple_haptic_telemetry),
      {NULL, 0},
  };
  return sizes;
}
