/* SPDX-License-Identifier: MIT */
/**
 * The C interface of the souple runtime: soft bodies in frictional contact, for programs in any
 * language.
 *
 * Results: every function that can fail returns a souple_status: 0, or the stable code of an issue, of
 * which souple_last_error_what() and its neighbours tell more on the same thread. A refused call
 * changes nothing, and writes to none of its results but `needed`. Functions that return something else
 * give a harmless value (0, NULL) for arguments that name nothing.
 *
 * Handles are opaque; destroying NULL does nothing. An asset or mesh may be released while worlds use
 * it.
 *
 * Structs that begin with struct_size are filled by their init function (`x_init(&x, sizeof x)`) before
 * fields are set; later versions may append fields. All other structs never change. What is said to be
 * reserved is 0.
 *
 * Buffers: (buffer, capacity, needed), counted in entries. NULL with capacity 0 asks for the count
 * alone. Too small: SOUPLE_API_BUFFER_TOO_SMALL, the count in `needed`, the buffer untouched. `needed`
 * may be NULL unless the buffer is.
 *
 * Texts are UTF-8, ended by 0, at most 4095 bytes. NULL is the empty text wherever a text is optional.
 * Returned texts live as long as the object that was asked.
 *
 * Units: SI, in the names: _m, _s, _n (newton), _kg, _pa, _rad. Vectors are in world axes, quaternions
 * (w, x, y, z) of unit length.
 *
 * Threads: a world, and all that reads it, is used by one thread at a time; different worlds by
 * different threads at once. A haptic channel has a physics thread, which is its world's, and a haptic
 * thread. Assets and meshes may be shared by all of them.
 *
 * Memory: souple_world_step, souple_world_move_grab, souple_world_set_load, functions that read into
 * buffers and those of a haptic channel allocate nothing once they have seen the largest case. But
 * souple_world_contacts, souple_world_pick, souple_world_snapshot, refusals, and all that makes or adds
 * something do.
 */
#ifndef SOUPLE_SOUPLE_H
#define SOUPLE_SOUPLE_H
#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && !defined(SOUPLE_STATIC)
#ifdef SOUPLE_BUILDING
#define SOUPLE_API __declspec(dllexport)
#else
#define SOUPLE_API __declspec(dllimport)
#endif
#elif defined(__GNUC__) && !defined(SOUPLE_STATIC)
#define SOUPLE_API __attribute__((visibility("default")))
#else
#define SOUPLE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- versions ---- */

#define SOUPLE_VERSION_MAJOR 0
#define SOUPLE_VERSION_MINOR 1
#define SOUPLE_VERSION_PATCH 0
/** Changes when a program has to be compiled again. */
#define SOUPLE_ABI_VERSION 1

/** 0, or the stable number of an issue. */
typedef int32_t souple_status;

/** Of the library that runs; the places may be NULL. */
SOUPLE_API void souple_version(int32_t* major, int32_t* minor, int32_t* patch);
SOUPLE_API const char* souple_version_string(void); /**< "0.1.0" */
SOUPLE_API int32_t souple_abi_version(void);
/** Pass the three macros of the header; SOUPLE_API_VERSION_MISMATCH if the library cannot serve it. */
SOUPLE_API souple_status souple_check_abi(int32_t abi_version, int32_t version_major,
                                          int32_t version_minor);
#define SOUPLE_CHECK_ABI() \
  souple_check_abi(SOUPLE_ABI_VERSION, SOUPLE_VERSION_MAJOR, SOUPLE_VERSION_MINOR)

/* ---- issues ---- */

/** Codes that a program is likely to compare with; souple_issue_at lists all of them. */
enum {
  SOUPLE_OK = 0,
  SOUPLE_API_ARGUMENT_MISSING = 1030,
  SOUPLE_API_ARGUMENT_INVALID = 1031,
  SOUPLE_API_STRUCT_SIZE_INVALID = 1032,
  SOUPLE_API_BUFFER_TOO_SMALL = 1033,
  SOUPLE_API_VERSION_MISMATCH = 1034,
  SOUPLE_API_NO_SUCH_OBJECT = 1035,
  SOUPLE_IO_FILE_MISSING = 2001,
  SOUPLE_IO_CANNOT_READ = 2002,
  SOUPLE_IO_OUT_OF_MEMORY = 2004,
  SOUPLE_ASSET_NOT_AN_ASSET = 3200,
  SOUPLE_ASSET_CORRUPT = 3201,
  SOUPLE_ASSET_MISSING_PART = 3202,
  SOUPLE_FIXED_SET_INVALID = 3302,
  SOUPLE_WORLD_PARAMETER_INVALID = 3401,
  SOUPLE_NO_MATCHING_COMPLIANCE = 3400,
  SOUPLE_LOAD_INVALID = 3406,
  SOUPLE_DRIVEN_NODES_INVALID = 3407,
  SOUPLE_RIGID_MESH_INVALID = 3410,
  SOUPLE_STEP_NOT_FINITE = 4200,
  SOUPLE_COMPLIANCE_NOT_LOADED = 4201,
  SOUPLE_SNAPSHOT_INVALID = 4301,
  SOUPLE_JOINT_INVALID = 4302,
  SOUPLE_SOLVER_NOT_CONVERGED = 4320,
  SOUPLE_INTERNAL_ERROR = 4900,
  SOUPLE_UNSUPPORTED_VERSION = 5000,
  SOUPLE_UNSUPPORTED_FEATURE = 5001
};

/** The last call of this thread that was refused; calls that succeed leave it. Never NULL; the texts
 *  live until the next refusal, and long ones are cut. */
SOUPLE_API souple_status souple_last_error_code(void);
SOUPLE_API const char* souple_last_error_what(void);  /**< this case, with its numbers */
SOUPLE_API const char* souple_last_error_where(void); /**< file, field, body; may be empty */
SOUPLE_API const char* souple_last_error_mend(void);  /**< what to do */

/** Of a code in general. NULL if it is none; of SOUPLE_OK "ok". */
SOUPLE_API const char* souple_issue_text(souple_status code); /**< one line */
SOUPLE_API const char* souple_issue_name(souple_status code); /**< "snapshot_invalid" */
SOUPLE_API const char* souple_issue_explanation(souple_status code);
SOUPLE_API const char* souple_issue_mend(souple_status code);
SOUPLE_API size_t souple_issue_count(void);
SOUPLE_API souple_status souple_issue_at(size_t index); /**< ascending; 0 beyond the last */

/* ---- plain values ---- */

typedef struct souple_vec3 {
  double x, y, z;
} souple_vec3;

typedef struct souple_triangle {
  int32_t corner[3]; /**< counter-clockwise seen from outside */
} souple_triangle;

/** x_world = rotation x_local + translation. */
typedef struct souple_pose {
  double rotation_wxyz[4];
  souple_vec3 translation_m;
} souple_pose;

/** Between two of them translation is linear and rotation slerped, outside they are held. */
typedef struct souple_keyframe {
  double time_s;
  souple_pose pose;
} souple_keyframe;

/* ---- assets ---- */

typedef struct souple_asset souple_asset;

/** Reading of a streamed compliance failed; called by the thread that reads. The texts live as long as
 *  the call. */
typedef void (*souple_streaming_failed)(void* user, souple_status code, const char* what);

typedef struct souple_load_options {
  uint32_t struct_size;
  int32_t no_compliances; /**< not 0: load none, for the exact contact method */
  int32_t visual;         /**< not 0: the surface to be shown, if there is one (default) */
  int32_t multigrid;      /**< not 0: what multigrid solvers need, if it is there */
  /** not 0: fetch hierarchical compliances while worlds run. Bytes in memory must then outlive the
   *  asset. */
  int32_t streaming;
  int32_t reserved;               /**< 0 */
  uint64_t table_bytes;           /**< of memory for tables of compliance blocks */
  const char* const* compliances; /**< names to load; none: all */
  size_t compliance_count;
  souple_streaming_failed streaming_failed; /**< may be NULL */
  void* streaming_user;
} souple_load_options;

SOUPLE_API souple_status souple_load_options_init(souple_load_options* options, size_t struct_size);

/** `options` may be NULL: defaults. Reads files: not for real-time threads. */
SOUPLE_API souple_status souple_asset_open_file(const char* path, const souple_load_options* options,
                                                souple_asset** asset);
/** The bytes of a file; not needed after the call, but for streaming. */
SOUPLE_API souple_status souple_asset_open_memory(const void* bytes, size_t size,
                                                  const souple_load_options* options,
                                                  souple_asset** asset);
SOUPLE_API void souple_asset_release(souple_asset* asset);

typedef struct souple_asset_facts {
  uint32_t struct_size;
  int32_t format_major, format_minor;
  int32_t solver; /**< SOUPLE_SOLVER_*: what steps are best begun with */
  size_t level_count;
  size_t node_count; /**< of the level that is simulated, as all that follows */
  size_t tet_count;
  size_t surface_node_count;
  size_t surface_triangle_count;
  size_t visual_vertex_count; /**< 0: none, or not loaded */
  size_t visual_triangle_count;
  size_t fixed_set_count;
  size_t compliance_count; /**< that were loaded */
  size_t resident_bytes;
  double longest_side_m;
  double mass_kg;
} souple_asset_facts;

SOUPLE_API souple_status souple_asset_facts_init(souple_asset_facts* facts, size_t struct_size);
SOUPLE_API souple_status souple_asset_get_facts(const souple_asset* asset, souple_asset_facts* facts);
/** Of the logical content, hex, as stored. */
SOUPLE_API const char* souple_asset_content_hash(const souple_asset* asset);
/** NULL beyond the last. */
SOUPLE_API const char* souple_asset_fixed_set_name(const souple_asset* asset, size_t index);
SOUPLE_API souple_status souple_asset_fixed_set_nodes(const souple_asset* asset, const char* name,
                                                      int32_t* nodes, size_t capacity, size_t* needed);

enum { SOUPLE_COMPLIANCE_DYNAMIC_STEP = 0, SOUPLE_COMPLIANCE_STATIC_EQUILIBRIUM = 1 };

typedef struct souple_compliance_facts {
  uint32_t struct_size;
  int32_t kind;          /**< SOUPLE_COMPLIANCE_* */
  const char* name;      /**< lives as long as the asset, as fixed_set */
  const char* fixed_set; /**< empty: none */
  double time_step_s;    /**< of an implicit Euler step; 0: static */
  size_t node_count;
} souple_compliance_facts;

SOUPLE_API souple_status souple_compliance_facts_init(souple_compliance_facts* facts,
                                                      size_t struct_size);
SOUPLE_API souple_status souple_asset_get_compliance(const souple_asset* asset, size_t index,
                                                     souple_compliance_facts* facts);

/** Nodes in the rest frame. */
SOUPLE_API souple_status souple_asset_rest_positions(const souple_asset* asset,
                                                     souple_vec3* positions_m, size_t capacity,
                                                     size_t* needed);
/** Nodes of the surface, ascending: its vertex k is node nodes[k]. */
SOUPLE_API souple_status souple_asset_surface_nodes(const souple_asset* asset, int32_t* nodes,
                                                    size_t capacity, size_t* needed);
/** Corners are vertices of the surface, as souple_world_surface_positions gives them. Loads name
 *  triangles by their place in this list. */
SOUPLE_API souple_status souple_asset_surface_triangles(const souple_asset* asset,
                                                        souple_triangle* triangles, size_t capacity,
                                                        size_t* needed);
SOUPLE_API souple_status souple_asset_visual_triangles(const souple_asset* asset,
                                                       souple_triangle* triangles, size_t capacity,
                                                       size_t* needed);

/* ---- rigid meshes ---- */

typedef struct souple_rigid_mesh souple_rigid_mesh;

/** A closed surface, wound outward, in the frame of the body. Checked and copied. */
SOUPLE_API souple_status souple_rigid_mesh_create(const souple_vec3* vertices_m, size_t vertex_count,
                                                  const souple_triangle* triangles,
                                                  size_t triangle_count, souple_rigid_mesh** mesh);
SOUPLE_API void souple_rigid_mesh_release(souple_rigid_mesh* mesh);

/* ---- worlds ---- */

typedef struct souple_world souple_world;

enum {
  SOUPLE_INTEGRATOR_IMPLICIT_EULER = 0,
  SOUPLE_INTEGRATOR_BDF2 = 1,
  SOUPLE_INTEGRATOR_QUASI_STATIC = 2,
  SOUPLE_INTEGRATOR_EXPLICIT_EULER = 3
};
enum { SOUPLE_CONTACT_WARPED = 0, SOUPLE_CONTACT_EXACT = 1, SOUPLE_CONTACT_PENALTY = 2 };
enum { SOUPLE_ROTATION_POLAR = 0, SOUPLE_ROTATION_QR = 1, SOUPLE_ROTATION_GRAM_SCHMIDT = 2 };
enum {
  SOUPLE_SOLVER_AUTOMATIC = 0,
  SOUPLE_SOLVER_JACOBI_PCG = 1,
  SOUPLE_SOLVER_GAUSS_SEIDEL_PCG = 2,
  SOUPLE_SOLVER_MULTIGRID = 3,
  SOUPLE_SOLVER_MULTIGRID_PCG = 4,
  SOUPLE_SOLVER_DIRECT = 5,
  SOUPLE_SOLVER_WARPED_PCG = 6,
  SOUPLE_SOLVER_WARPED_MULTIGRID_PCG = 7
};
enum { SOUPLE_UNCONVERGED_KEEP_BEST = 0, SOUPLE_UNCONVERGED_REFUSE = 1 };

typedef struct souple_world_settings {
  uint32_t struct_size;
  int32_t integrator; /**< SOUPLE_INTEGRATOR_* */
  double time_step_s; /**< the warped method needs a compliance for it */
  souple_vec3 gravity_m_s2;
  double friction;         /**< of pairs without a rule of their own, in [0, 10] */
  double alarm_distance_m; /**< contacts are built below this gap; 0: chosen */
  int32_t contact_method;  /**< SOUPLE_CONTACT_* */
  int32_t rotation_method; /**< SOUPLE_ROTATION_* */
  int32_t feed_forward_forces;
  int32_t contact_passes;       /**< 1 to 20 */
  double penalty_stiffness_n_m; /**< penalty method only; 0: chosen */
  double sleep_after_s;         /**< 0: never */
  double sleep_speed_sides_s;   /**< in sides of the body per second */
  double contact_tolerance;
  int32_t contact_max_sweeps;
  int32_t solver; /**< SOUPLE_SOLVER_* */
  double free_motion_tolerance;
  int32_t free_motion_max_iterations;
  int32_t unconverged;  /**< SOUPLE_UNCONVERGED_* */
  int32_t measure_laws; /**< not 0: fill the law and energy figures of reports */
  int32_t reserved;     /**< 0 */
  /** The contact solver goes on until no contact is left deeper; 0: not asked. */
  double contact_penetration_m;
} souple_world_settings;

SOUPLE_API souple_status souple_world_settings_init(souple_world_settings* settings,
                                                    size_t struct_size);
/** `settings` may be NULL: defaults. */
SOUPLE_API souple_status souple_world_create(const souple_world_settings* settings,
                                             souple_world** world);
SOUPLE_API void souple_world_destroy(souple_world* world);

/* ---- bodies ---- */

typedef uint32_t souple_body;
/** Where a body may be left out: the world itself. */
#define SOUPLE_NO_BODY UINT32_MAX

/** A part of a fixed set that moves along a path: node k is at pose(t) X_k, X_k its rest position. */
typedef struct souple_driven_set {
  const char* name;
  const souple_keyframe* path; /**< ascending times */
  size_t path_count;
} souple_driven_set;

typedef struct souple_soft_body_description {
  uint32_t struct_size;
  int32_t self_contact; /**< not 0: its surface may touch itself */
  const char* name;
  souple_pose pose;
  souple_vec3 velocity_m_s;
  souple_vec3 angular_velocity_rad_s; /**< about the centre of mass */
  const char* fixed_set;              /**< a set of the asset; empty: free */
  const souple_driven_set* driven;
  size_t driven_count;
  /** Two bodies may collide if each one's groups meet the other's mask. */
  uint32_t collision_groups, collision_mask;
} souple_soft_body_description;

SOUPLE_API souple_status souple_soft_body_description_init(souple_soft_body_description* description,
                                                           size_t struct_size);
/** The asset may be released afterwards. */
SOUPLE_API souple_status souple_world_add_soft_body(souple_world* world, const souple_asset* asset,
                                                    const souple_soft_body_description* description,
                                                    souple_body* body);

enum {
  SOUPLE_SHAPE_PLANE = 0, /**< local z = 0, solid below */
  SOUPLE_SHAPE_SPHERE = 1,
  SOUPLE_SHAPE_BOX = 2,
  SOUPLE_SHAPE_CAPSULE = 3,
  SOUPLE_SHAPE_MESH = 4
};
enum {
  SOUPLE_MOTION_FIXED = 0,  /**< at `pose` */
  SOUPLE_MOTION_DRIVEN = 1, /**< along `path` */
  SOUPLE_MOTION_FREE = 2    /**< starts at `pose` and moves by the forces on it */
};

typedef struct souple_rigid_body_description {
  uint32_t struct_size;
  int32_t shape;    /**< SOUPLE_SHAPE_* */
  int32_t motion;   /**< SOUPLE_MOTION_* */
  int32_t reserved; /**< 0 */
  const char* name;
  double radius_m;               /**< sphere, capsule */
  souple_vec3 half_extents_m;    /**< box */
  double half_length_m;          /**< capsule: of the segment on the local z axis */
  const souple_rigid_mesh* mesh; /**< mesh, else NULL; may be released afterwards */
  souple_pose pose;
  const souple_keyframe* path;
  size_t path_count;
  double mass_kg; /**< free; 0: from the density */
  double density_kg_m3;
  souple_vec3 velocity_m_s; /**< free, of the centre of mass */
  souple_vec3 angular_velocity_rad_s;
  uint32_t collision_groups, collision_mask;
} souple_rigid_body_description;

SOUPLE_API souple_status souple_rigid_body_description_init(souple_rigid_body_description* description,
                                                            size_t struct_size);
SOUPLE_API souple_status souple_world_add_rigid_body(souple_world* world,
                                                     const souple_rigid_body_description* description,
                                                     souple_body* body);

SOUPLE_API size_t souple_world_body_count(const souple_world* world);
SOUPLE_API const char* souple_world_body_name(const souple_world* world,
                                              souple_body body); /**< or NULL */
SOUPLE_API int32_t souple_world_is_soft(const souple_world* world, souple_body body);
/** SOUPLE_SOLVER_* that solves the steps of a soft body. */
SOUPLE_API souple_status souple_world_solver(const souple_world* world, souple_body soft_body,
                                             int32_t* solver);

/** What holds between two bodies from the next step on; friction in [0, 10], restitution in [0, 1]. */
SOUPLE_API souple_status souple_world_set_pair(souple_world* world, souple_body a, souple_body b,
                                               int32_t collides, double friction, double restitution);

/* ---- loads ---- */

typedef uint64_t souple_load;

enum {
  SOUPLE_LOAD_NODE_FORCE = 0,  /**< N, in all, shared equally by `nodes` */
  SOUPLE_LOAD_POINT_FORCE = 1, /**< N, at a barycentric point of a surface triangle */
  SOUPLE_LOAD_TRACTION = 2,    /**< Pa, on the rest area of `triangles` */
  SOUPLE_LOAD_PRESSURE = 3     /**< Pa, on `triangles`, > 0 pushes inwards */
};

/** Linear in time between two of them, held outside. */
typedef struct souple_load_keyframe {
  double time_s;
  souple_vec3 vector; /**< N or Pa; not of a pressure */
  double pressure_pa; /**< of a pressure only */
} souple_load_keyframe;

typedef struct souple_load_description {
  uint32_t struct_size;
  int32_t kind; /**< SOUPLE_LOAD_* */
  const char* name;
  int32_t follows;  /**< not 0: turns with the body */
  int32_t triangle; /**< of a point force: place in the surface triangles */
  double weight[3]; /**< of its corners, sum 1 */
  const int32_t* nodes;
  size_t node_count;
  const int32_t* triangles; /**< none: the whole surface */
  size_t triangle_count;
  const souple_load_keyframe* course;
  size_t course_count;
} souple_load_description;

SOUPLE_API souple_status souple_load_description_init(souple_load_description* description,
                                                      size_t struct_size);
SOUPLE_API souple_status souple_world_add_load(souple_world* world, souple_body soft_body,
                                               const souple_load_description* description,
                                               souple_load* load);
/** Replaces the course of a load by a value that it keeps. Allocates nothing. */
SOUPLE_API souple_status souple_world_set_load(souple_world* world, souple_load load,
                                               souple_vec3 vector, double pressure_pa);

/* ---- joints and grabs ---- */

typedef uint32_t souple_joint;
typedef uint32_t souple_grab;

enum { SOUPLE_JOINT_BALL = 0, SOUPLE_JOINT_HINGE = 1, SOUPLE_JOINT_WELD = 2 };

/** Holds two bodies together where they are. */
typedef struct souple_joint_description {
  uint32_t struct_size;
  int32_t kind; /**< SOUPLE_JOINT_* */
  const char* name;
  souple_body body_a;
  souple_body body_b; /**< or SOUPLE_NO_BODY: the world */
  souple_vec3 point_m;
  souple_vec3 axis; /**< of a hinge */
  double arm_m;     /**< between the points of a hinge or weld */
  double reach_m;   /**< of soft bodies: to the nearest point of their surface */
  int32_t collide;  /**< not 0: the two bodies still collide */
  int32_t reserved; /**< 0 */
} souple_joint_description;

SOUPLE_API souple_status souple_joint_description_init(souple_joint_description* description,
                                                       size_t struct_size);
SOUPLE_API souple_status souple_world_add_joint(souple_world* world,
                                                const souple_joint_description* description,
                                                souple_joint* joint);

/** Takes hold of a body: of the nearest node, or of all surface nodes within `radius_m`, at most
 *  `most_nodes` (1 to 10000). What is held follows the handle rigidly, with the offsets it had. */
SOUPLE_API souple_status souple_world_grab(souple_world* world, souple_body body, souple_vec3 point_m,
                                           double radius_m, int32_t most_nodes, souple_grab* grab);
/** Where the handle is at the end of the next step; it starts at the identity. */
SOUPLE_API souple_status souple_world_move_grab(souple_world* world, souple_grab grab,
                                                souple_pose pose);
SOUPLE_API souple_status souple_world_release(souple_world* world, souple_grab grab);

typedef struct souple_pick_hit {
  souple_body body; /**< SOUPLE_NO_BODY: nothing was hit, and the rest is 0 */
  int32_t node;     /**< of a soft body: nearest corner of the triangle that was hit, else -1 */
  double distance_m;
  souple_vec3 point_m;
  souple_vec3 normal; /**< outward */
} souple_pick_hit;

/** Where a ray meets a body first; the direction may have any length but 0. */
SOUPLE_API souple_status souple_world_pick(const souple_world* world, souple_vec3 origin_m,
                                           souple_vec3 direction, double reach_m, souple_pick_hit* hit);

/* ---- steps ---- */

typedef void (*souple_job)(void* job_context, size_t index);
/** Calls job(job_context, 0) ... job(job_context, count - 1), each once, in any order and on any
 * threads, and returns when all are done. Must not throw. */
typedef void (*souple_run_jobs)(void* user, size_t count, souple_job job, void* job_context);

/** Bodies are stepped as jobs of the application, with the same bits; NULL: one after another. */
SOUPLE_API souple_status souple_world_run_jobs_with(souple_world* world, souple_run_jobs run_jobs,
                                                    void* user);

typedef struct souple_step_report {
  uint32_t struct_size;
  int32_t contact_sweeps; /**< of the island that took most */
  size_t contact_count;   /**< that entered the contact problem */
  size_t active_count;    /**< of these, carrying force */
  size_t uncovered_count; /**< left out because no compliance covers them */
  size_t island_count;
  size_t sleeping_count;
  double contact_residual; /**< natural map over the forces */
  double free_motion_residual;
  int32_t free_motion_iterations;
  int32_t unconverged_count; /**< solves that missed their tolerance */
  double free_motion_s;      /**< wall time by phase */
  double collision_s;
  double compliance_s;
  double contact_solve_s;
  double correction_s;
  double total_s;
  /* With measure_laws: */
  double worst_penetration_m;
  double worst_surface_depth_m;
  double worst_joint_error_m;
  double cone_violation; /**< max (|f_t| - mu f_n) / max |f| */
  double kinetic_energy_j;
  double elastic_energy_j;
  double potential_energy_j;
  double load_work_j;
  double lost_energy_j;
  souple_vec3 linear_momentum_kg_m_s;
  souple_vec3 angular_momentum_kg_m2_s;
} souple_step_report;

SOUPLE_API souple_status souple_step_report_init(souple_step_report* report, size_t struct_size);
/** `report` may be NULL. When refused the state is that before the step. */
SOUPLE_API souple_status souple_world_step(souple_world* world, souple_step_report* report);
SOUPLE_API double souple_world_time_s(const souple_world* world);
/** A body and all that it touches. */
SOUPLE_API souple_status souple_world_wake(souple_world* world, souple_body body);
SOUPLE_API int32_t souple_world_is_asleep(const souple_world* world, souple_body body);

/* ---- what a step has made ---- */

/** All nodes of a soft body. */
SOUPLE_API souple_status souple_world_positions(const souple_world* world, souple_body soft_body,
                                                souple_vec3* positions_m, size_t capacity,
                                                size_t* needed);
SOUPLE_API souple_status souple_world_velocities(const souple_world* world, souple_body soft_body,
                                                 souple_vec3* velocities_m_s, size_t capacity,
                                                 size_t* needed);
/** Vertices of the simulated surface, as souple_asset_surface_triangles uses them. */
SOUPLE_API souple_status souple_world_surface_positions(const souple_world* world,
                                                        souple_body soft_body, souple_vec3* positions_m,
                                                        size_t capacity, size_t* needed);
/** The same in single precision: 3 floats an entry. */
SOUPLE_API souple_status souple_world_surface_positions_f32(const souple_world* world,
                                                            souple_body soft_body, float* xyz_m,
                                                            size_t capacity, size_t* needed);
/** Vertices of the surface to be shown; SOUPLE_ASSET_MISSING_PART without one. */
SOUPLE_API souple_status souple_world_visual_positions(const souple_world* world, souple_body soft_body,
                                                       souple_vec3* positions_m, size_t capacity,
                                                       size_t* needed);
SOUPLE_API souple_status souple_world_visual_positions_f32(const souple_world* world,
                                                           souple_body soft_body, float* xyz_m,
                                                           size_t capacity, size_t* needed);
SOUPLE_API souple_status souple_world_rigid_pose(const souple_world* world, souple_body rigid_body,
                                                 souple_pose* pose);
/** Of the centre of mass; zero of bodies that are not free. The places may be NULL. */
SOUPLE_API souple_status souple_world_rigid_velocity(const souple_world* world, souple_body rigid_body,
                                                     souple_vec3* velocity_m_s,
                                                     souple_vec3* angular_velocity_rad_s);

typedef struct souple_contact {
  souple_body body_a, body_b; /**< the same in self-contact */
  souple_vec3 point_m;
  souple_vec3 normal;  /**< unit, from B to A */
  souple_vec3 force_n; /**< on A; the opposite on B */
  double gap_m;        /**< after the step; < 0 penetrates */
} souple_contact;

/** Of the last step. Allocates. */
SOUPLE_API souple_status souple_world_contacts(const souple_world* world, souple_contact* contacts,
                                               size_t capacity, size_t* needed);

enum { SOUPLE_EVENT_BEGIN = 0, SOUPLE_EVENT_PERSIST = 1, SOUPLE_EVENT_END = 2 };

typedef struct souple_contact_event {
  int32_t kind; /**< SOUPLE_EVENT_BEGIN, _PERSIST, _END */
  uint32_t contact_count;
  souple_body body_a, body_b; /**< a <= b */
  souple_vec3 force_n;        /**< on A, of all their contacts; 0 at the end */
} souple_contact_event;

/** Pairs of bodies that began, kept or ended to press on each other in the last step. */
SOUPLE_API souple_status souple_world_contact_events(const souple_world* world,
                                                     souple_contact_event* events, size_t capacity,
                                                     size_t* needed);

/* ---- state ---- */

/** `count` entries of both, one for every node. */
SOUPLE_API souple_status souple_world_set_soft_state(souple_world* world, souple_body soft_body,
                                                     const souple_vec3* positions_m,
                                                     const souple_vec3* velocities_m_s, size_t count);
/** Of a free rigid body. */
SOUPLE_API souple_status souple_world_set_rigid_state(souple_world* world, souple_body rigid_body,
                                                      souple_pose pose, souple_vec3 velocity_m_s,
                                                      souple_vec3 angular_velocity_rad_s);
/** Takes over the state of a world with the same bodies. */
SOUPLE_API souple_status souple_world_copy_state(souple_world* world, const souple_world* other);
/** The state as bytes; after restore the steps have the same bits. Both allocate. */
SOUPLE_API souple_status souple_world_snapshot(const souple_world* world, void* bytes, size_t capacity,
                                               size_t* needed);
SOUPLE_API souple_status souple_world_restore(souple_world* world, const void* bytes, size_t size);

/* ---- a hand: haptic channels ---- */

/*
 * A tool that a hand holds, between a world that steps at its own rate and a hand that wants forces at
 * another. Neither thread ever waits for the other.
 *
 *   physics thread                                  haptic thread
 *     souple_haptic_begin_step(channel, world);       souple_haptic_tick(channel, &sample, &wrench);
 *     souple_world_step(world, NULL);
 *     souple_haptic_publish(channel, world);
 */

/** A rigid part of a tool: with the opening phi of the tool its shape is at
 *  handle * hinge * rotation(axis, turn_per_opening phi) * mount. A spring and damper hold it there; it
 * has no mass, so that free of contact it is there. */
typedef struct souple_jaw_description {
  uint32_t struct_size;
  int32_t shape; /**< SOUPLE_SHAPE_*, anything but a plane */
  double radius_m;
  souple_vec3 half_extents_m;
  double half_length_m;
  const souple_rigid_mesh* mesh;
  souple_pose hinge;       /**< in the frame of the handle */
  souple_vec3 axis;        /**< in the frame of the hinge */
  souple_pose mount;       /**< of the shape */
  double turn_per_opening; /**< of two jaws that open alike 0.5 and -0.5; 0: rigid */
  double stiffness_n_m;
  double turn_stiffness_nm_rad;
  double damping_n_s_m;
  double turn_damping_nm_s_rad;
  souple_vec3 centre_m; /**< of spring and damper, in the frame of the shape */
  double look_ahead_m;  /**< contacts that are farther open by so much are kept for the ticks */
} souple_jaw_description;

SOUPLE_API souple_status souple_jaw_description_init(souple_jaw_description* description,
                                                     size_t struct_size);

typedef struct souple_tool_description {
  uint32_t struct_size;
  int32_t reserved; /**< 0 */
  const char* name;
  /** One or two, one after another, all of the struct_size of the first; they do not touch each other.
   */
  const souple_jaw_description* jaws;
  size_t jaw_count;
  souple_pose pose; /**< of the handle, to begin with */
  double opening_rad;
  uint32_t collision_groups, collision_mask;
} souple_tool_description;

SOUPLE_API souple_status souple_tool_description_init(souple_tool_description* description,
                                                      size_t struct_size);

typedef struct souple_haptic_settings {
  uint32_t struct_size;
  int32_t max_sweeps;        /**< of one tick */
  size_t contact_capacity;   /**< 1 to 4096; of more contacts the most loaded are taken */
  double tick_budget_s;      /**< wall time in which a tick begins no further sweep */
  double residual_goal;      /**< of the laws (natural map over the norm of the forces) */
  double hand_over_s;        /**< the force before a publication fades; 0: one physics period */
  double hand_over_share;    /**< sooner, by steps of this share of the largest recent force */
  double dead_after_s;       /**< physics that has published nothing for so long is taken for dead */
  double fade_s;             /**< from full force to none, and back */
  double credible_speed_m_s; /**< faster samples are refused */
  double credible_turn_rad_s;
  double recover_after_s; /**< a device that keeps to an incredible place is believed after so long */
  double reach_m;         /**< how far ticks take a contact point from where physics had it */
  /* What the device can do; applied last. Infinite: no limit. */
  double device_rate_hz; /**< how often it wants a wrench */
  double device_force_n;
  double device_torque_nm;
  double device_opening_nm;
  double device_force_slew_n_s;
  double device_torque_slew_nm_s;
  int32_t device_has_opening;
  int32_t reserved; /**< 0 */
  double lead_s;    /**< ticks look so far ahead: what the device is late by; 0 to 0.02 */
} souple_haptic_settings;

SOUPLE_API souple_status souple_haptic_settings_init(souple_haptic_settings* settings,
                                                     size_t struct_size);

typedef struct souple_haptic_channel souple_haptic_channel;

/** Adds the tool to the world. `settings` may be NULL: defaults. */
SOUPLE_API souple_status souple_haptic_channel_create(souple_world* world,
                                                      const souple_tool_description* tool,
                                                      const souple_haptic_settings* settings,
                                                      souple_haptic_channel** channel);
/** Both threads have ended. The tool stays in the world. */
SOUPLE_API void souple_haptic_channel_destroy(souple_haptic_channel* channel);
/** The bodies of the jaws. */
SOUPLE_API souple_status souple_haptic_tool_bodies(const souple_haptic_channel* channel,
                                                   souple_body* bodies, size_t capacity,
                                                   size_t* needed);

/** What a device measured at one instant, in the world's frame. */
typedef struct souple_device_sample {
  double time_s;    /**< of the device's own clock, which never goes back */
  souple_pose pose; /**< of the handle */
  double opening_rad;
} souple_device_sample;

/** What the hand is to feel; the torque is about the handle's origin. */
typedef struct souple_wrench {
  souple_vec3 force_n;
  souple_vec3 torque_nm;
  double opening_nm; /**< opens the jaws where positive */
} souple_wrench;

/* Physics thread. `world` is the one that the channel was made with. */

/** Moves the tool to the newest pose that the haptic thread believed. */
SOUPLE_API souple_status souple_haptic_begin_step(souple_haptic_channel* channel, souple_world* world);
/** Makes the contacts of the last step those that ticks solve. */
SOUPLE_API souple_status souple_haptic_publish(souple_haptic_channel* channel,
                                               const souple_world* world);
/** `is_there` 0: no sample has been believed yet, and `sample` is unchanged. */
SOUPLE_API souple_status souple_haptic_newest_sample(souple_haptic_channel* channel,
                                                     souple_device_sample* sample, int32_t* is_there);

/* Haptic thread. */

/** `sample` NULL: the device has nothing new. Samples that no hand could have made (not finite, a jump,
 * a clock that goes back) are no error: the last good one is held, and telemetry counts them. */
SOUPLE_API souple_status souple_haptic_tick(souple_haptic_channel* channel,
                                            const souple_device_sample* sample, souple_wrench* wrench);
/** Of the last tick, before limits, hand-over and fading; and the residual of the laws. May be NULL. */
SOUPLE_API souple_status souple_haptic_last_tick(const souple_haptic_channel* channel,
                                                 souple_wrench* lawful, double* residual);

/** Bin k counts values in [lowest ratio^(k-1), lowest ratio^k), the first all below `lowest`, the last
 *  all above. */
typedef struct souple_histogram {
  double lowest, ratio;
  uint64_t count[48];
} souple_histogram;

typedef struct souple_haptic_telemetry {
  uint32_t struct_size;
  int32_t reserved;
  uint64_t ticks;
  uint64_t sweeps; /**< of all ticks */
  uint64_t idle_ticks;
  uint64_t deadline_misses;   /**< ticks longer than the budget, wall time */
  uint64_t unconverged_ticks; /**< that ended above the residual goal */
  uint64_t publications;
  uint64_t hand_overs; /**< publications that a tick took up */
  uint64_t refused_not_finite;
  uint64_t refused_jumps;
  uint64_t refused_clock;
  uint64_t missing_samples;
  uint64_t recoveries;
  uint64_t dead_ticks;        /**< physics silent for too long */
  uint64_t clamped_ticks;     /**< the hand beyond the reach */
  uint64_t limited_ticks;     /**< limits of the device at work */
  uint64_t contacts_left_out; /**< of the newest problem, as the next two */
  uint64_t contacts;
  uint64_t active_contacts;
  uint64_t active_sum; /**< over all ticks, as the next */
  uint64_t contact_sum;
  double largest_force_n;
  double largest_hand_over_step_n;
  double largest_step_n;
  double longest_silence_s;
  souple_histogram tick_time_s;
  souple_histogram sweeps_per_tick;
  souple_histogram residual;
  souple_histogram hand_over_step_n;
} souple_haptic_telemetry;

SOUPLE_API souple_status souple_haptic_telemetry_init(souple_haptic_telemetry* telemetry,
                                                      size_t struct_size);
/** Any thread: counters that may be a tick apart from each other. */
SOUPLE_API souple_status souple_haptic_get_telemetry(const souple_haptic_channel* channel,
                                                     souple_haptic_telemetry* telemetry);
/** The bound that a share of all values stay below; 0 of no values, infinite of the last bin. */
SOUPLE_API double souple_histogram_quantile(const souple_histogram* histogram, double share);

#ifdef __cplusplus
}
#endif
#endif
