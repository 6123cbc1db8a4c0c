/* SPDX-License-Identifier: MIT */
/* A program in C11 that uses the runtime, as functions that a test calls. */
#ifndef SOUPLE_TESTS_C_PROGRAM_H
#define SOUPLE_TESTS_C_PROGRAM_H
#include <souple/souple.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Drops the asset from 0.1 m onto a plane, tilted, and gives the positions of its nodes after so many
 *  steps. `count` is the room, and then the number of nodes. */
souple_status c_drop(const char* asset_file, int steps, souple_vec3* positions_m, size_t* count);

/** Sizes of all structs as the C compiler lays them out; ends with a name that is NULL. */
typedef struct c_struct_size {
  const char* name;
  size_t size;
} c_struct_size;
const c_struct_size* c_struct_sizes(void);

#ifdef __cplusplus
}
#endif
#endif
