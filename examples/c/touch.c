/* SPDX-License-Identifier: MIT */
/*
 * Drops a soft body onto the floor, pokes it with a ball that a hand holds, and shows that a snapshot
 * brings back the same bits. Usage: touch ASSET
 *
 * The asset needs no compliance: contacts are computed by the exact method. With a compliance for the
 * time step, leave `contact_method` at its default, which is much faster.
 */
#include <souple/souple.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A frame of an application: what is drawn, in memory that is allocated once. */
typedef struct frame {
  souple_vec3* vertices_m;
  size_t vertex_count;
} frame;

static int failed(const char* doing) {
  fprintf(stderr, "%s: S%d %s (%s)\n  mend: %s\n", doing, (int)souple_last_error_code(),
          souple_last_error_what(), souple_last_error_where(), souple_last_error_mend());
  return 1;
}

static souple_world* make_world(void) {
  souple_world_settings settings;
  souple_world* world = NULL;
  if (souple_world_settings_init(&settings, sizeof settings) != SOUPLE_OK) return NULL;
  settings.time_step_s = 0.01;
  settings.contact_method = SOUPLE_CONTACT_EXACT;
  return souple_world_create(&settings, &world) == SOUPLE_OK ? world : NULL;
}

static souple_status add_bodies(souple_world* world, const souple_asset* asset, souple_body* body) {
  souple_soft_body_description soft;
  souple_rigid_body_description plane;
  souple_body floor_body;
  souple_status status = souple_soft_body_description_init(&soft, sizeof soft);
  if (status == SOUPLE_OK) status = souple_rigid_body_description_init(&plane, sizeof plane);
  if (status != SOUPLE_OK) return status;
  soft.name = "soft body";
  soft.pose.translation_m.z = 0.05;
  plane.name = "floor";
  status = souple_world_add_soft_body(world, asset, &soft, body);
  if (status == SOUPLE_OK) status = souple_world_add_rigid_body(world, &plane, &floor_body);
  return status;
}

static souple_status read_frame(const souple_world* world, souple_body body, frame* out) {
  if (!out->vertices_m) {
    souple_status status = souple_world_surface_positions(world, body, NULL, 0, &out->vertex_count);
    if (status != SOUPLE_OK) return status;
    out->vertices_m = malloc(out->vertex_count * sizeof *out->vertices_m);
    if (!out->vertices_m) return SOUPLE_IO_OUT_OF_MEMORY;
  }
  return souple_world_surface_positions(world, body, out->vertices_m, out->vertex_count, NULL);
}

static double lowest_z(const frame* shown) {
  double lowest = shown->vertices_m[0].z;
  for (size_t k = 1; k < shown->vertex_count; ++k)
    if (shown->vertices_m[k].z < lowest) lowest = shown->vertices_m[k].z;
  return lowest;
}

static double highest_z(const frame* shown) {
  double highest = shown->vertices_m[0].z;
  for (size_t k = 1; k < shown->vertex_count; ++k)
    if (shown->vertices_m[k].z > highest) highest = shown->vertices_m[k].z;
  return highest;
}

static souple_status run(souple_world* world, int steps, souple_step_report* report) {
  souple_status status = SOUPLE_OK;
  for (int k = 0; status == SOUPLE_OK && k < steps; ++k) status = souple_world_step(world, report);
  return status;
}

/* 1 if the steps after a snapshot come out with the same bits twice, 0 if not, -1 if refused. */
static int repeats(souple_world* world, souple_body body, int steps) {
  frame first = {NULL, 0}, second = {NULL, 0};
  size_t size = 0;
  void* bytes = NULL;
  int same = -1;
  if (souple_world_snapshot(world, NULL, 0, &size) == SOUPLE_OK && (bytes = malloc(size)) != NULL &&
      souple_world_snapshot(world, bytes, size, NULL) == SOUPLE_OK &&
      run(world, steps, NULL) == SOUPLE_OK && read_frame(world, body, &first) == SOUPLE_OK &&
      souple_world_restore(world, bytes, size) == SOUPLE_OK && run(world, steps, NULL) == SOUPLE_OK &&
      read_frame(world, body, &second) == SOUPLE_OK)
    same =
        memcmp(first.vertices_m, second.vertices_m, first.vertex_count * sizeof *first.vertices_m) == 0;
  free(bytes);
  free(first.vertices_m);
  free(second.vertices_m);
  return same;
}

/* A ball on a hand, `above_m` at first. */
static souple_haptic_channel* take_ball(souple_world* world, souple_vec3 above_m) {
  souple_jaw_description ball;
  souple_tool_description tool;
  souple_haptic_channel* channel = NULL;
  if (souple_jaw_description_init(&ball, sizeof ball) != SOUPLE_OK) return NULL;
  if (souple_tool_description_init(&tool, sizeof tool) != SOUPLE_OK) return NULL;
  ball.shape = SOUPLE_SHAPE_SPHERE;
  ball.radius_m = 0.015;
  ball.stiffness_n_m = 300;
  tool.name = "ball";
  tool.jaws = &ball;
  tool.jaw_count = 1;
  tool.pose.translation_m = above_m;
  return souple_haptic_channel_create(world, &tool, NULL, &channel) == SOUPLE_OK ? channel : NULL;
}

/* Goes down by `depth_m` in a second, ten ticks a step, and gives the last force. An application has a
 * thread for the steps and one for the ticks. */
static souple_status poke(souple_world* world, souple_haptic_channel* channel, souple_vec3 from_m,
                          double depth_m, souple_wrench* wrench) {
  souple_status status = SOUPLE_OK;
  souple_device_sample sample = {0, {{1, 0, 0, 0}, {0, 0, 0}}, 0};
  sample.pose.translation_m = from_m;
  for (int tick = 0; status == SOUPLE_OK && tick < 1000; ++tick) {
    if (tick % 10 == 0) {
      status = souple_haptic_begin_step(channel, world);
      if (status == SOUPLE_OK) status = souple_world_step(world, NULL);
      if (status == SOUPLE_OK) status = souple_haptic_publish(channel, world);
    }
    sample.time_s = 0.001 * (tick + 1);
    sample.pose.translation_m.z = from_m.z - depth_m * (tick + 1) / 1000;
    if (status == SOUPLE_OK) status = souple_haptic_tick(channel, &sample, wrench);
  }
  return status;
}

static int touch(souple_world* world, const souple_asset* asset, frame* shown) {
  souple_step_report report;
  souple_body body;
  souple_wrench wrench;
  souple_vec3 above = {0, 0, 0};
  int same;
  if (add_bodies(world, asset, &body) != SOUPLE_OK) return failed("add bodies");
  if (souple_step_report_init(&report, sizeof report) != SOUPLE_OK) return failed("report");
  if (run(world, 200, &report) != SOUPLE_OK) return failed("step");
  if (read_frame(world, body, shown) != SOUPLE_OK) return failed("read the surface");
  printf("after %.2f s: lowest vertex %.5f m, %zu contacts\n", souple_world_time_s(world),
         lowest_z(shown), report.active_count);
  same = repeats(world, body, 20);
  if (same < 0) return failed("snapshot");
  printf("snapshot: %s\n", same ? "same bits" : "other bits");

  for (size_t k = 0; k < shown->vertex_count; ++k) {
    above.x += shown->vertices_m[k].x / (double)shown->vertex_count;
    above.y += shown->vertices_m[k].y / (double)shown->vertex_count;
  }
  above.z = highest_z(shown) + 0.02;
  souple_haptic_channel* channel = take_ball(world, above);
  if (!channel) return failed("take the ball");
  const souple_status status = poke(world, channel, above, 0.02, &wrench);
  souple_haptic_channel_destroy(channel);
  if (status != SOUPLE_OK) return failed("poke");
  printf("the hand feels %.3f N\n", wrench.force_n.z);
  return same && lowest_z(shown) > -0.01 && wrench.force_n.z > 0 ? 0 : 2;
}

int main(int argument_count, char** arguments) {
  souple_asset* asset = NULL;
  souple_world* world = NULL;
  frame shown = {NULL, 0};
  int result;
  if (argument_count != 2) {
    fprintf(stderr, "usage: touch ASSET\n");
    return 1;
  }
  if (SOUPLE_CHECK_ABI() != SOUPLE_OK) return failed("library");
  if (souple_asset_open_file(arguments[1], NULL, &asset) != SOUPLE_OK) return failed("open");
  world = make_world();
  result = world ? touch(world, asset, &shown) : failed("make a world");
  free(shown.vertices_m);
  souple_world_destroy(world);
  souple_asset_release(asset);
  return result;
}
