// SPDX-License-Identifier: MIT
// Names in the file, in one place for reader and writer. Version 1.3.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "formats/core/asset.hpp"

namespace souple::layout {

inline constexpr const char* format_name = "souple";

// Root attributes.
inline constexpr const char* format = "format";
inline constexpr const char* version_major = "version_major";
inline constexpr const char* version_minor = "version_minor";
inline constexpr const char* generator = "generator";
inline constexpr const char* recipe = "recipe";
inline constexpr const char* input_name = "input_name";
inline constexpr const char* input_hash = "input_hash";
inline constexpr const char* content_hash = "content_hash";
// New in 1.3, may be absent: a name of solver_names, not "automatic".
inline constexpr const char* default_solver = "default_solver";

// mesh/levels/<l>
inline constexpr const char* mesh = "mesh";
inline constexpr const char* levels = "levels";
inline constexpr const char* nodes = "nodes";  // [m, 3] float64, metres; lists elsewhere [n] int32
inline constexpr const char* tets = "tets";    // [t, 4] int32
inline constexpr const char* boundary = "boundary";  // [b, 3] int32
// Above level 0 parents or an embedding in the coarser level, or both; new in 1.1: all but parents.
inline constexpr const char* parents = "parents";                           // [m, 2] int32
inline constexpr const char* embedding_tets = "embedding_tets";             // [m] int32
inline constexpr const char* embedding_weights = "embedding_weights";       // [m, 4] float64
inline constexpr const char* parents_error = "rigid_motion_error_parents";  // attributes, may be absent
inline constexpr const char* embedding_error = "rigid_motion_error_embedding";

// multigrid/<l>, optional, new in 1.3: LevelTransition from level l, 1 and up, to level l - 1
inline constexpr const char* multigrid = "multigrid";
inline constexpr const char* row_begin = "prolongation_begin";   // [m + 1] int32
inline constexpr const char* column = "prolongation_column";     // [entries] int32
inline constexpr const char* weight = "prolongation_weight";     // [entries] float64
inline constexpr const char* pattern_begin = "pattern_begin";    // [n + 1] int32
inline constexpr const char* pattern_column = "pattern_column";  // [blocks] int32
inline constexpr const char* plan_pieces = "plan_pieces";        // [pieces, 4] int32
inline constexpr const char* plan_slots = "plan_slots";          // [fine blocks, 4] uint8
inline constexpr const char* plan_targets = "plan_targets";      // [slots, 4] int32

// mesh/visual, optional, new in 1.1: triangles [t, 3] int32 and an embedding in the finest level
inline constexpr const char* visual = "visual";
inline constexpr const char* vertices = "vertices";  // [v, 3] float64, metres
inline constexpr const char* triangles = "triangles";

// material
inline constexpr const char* material = "material";
inline constexpr const char* rayleigh_mass = "rayleigh_mass_per_s";
inline constexpr const char* rayleigh_stiffness = "rayleigh_stiffness_s";
inline constexpr const char* region_names = "region_names";  // [r] fixed-length text
inline constexpr const char* young = "young_pa";             // [r] float64
inline constexpr const char* poisson = "poisson";            // [r] float64
inline constexpr const char* density = "density_kg_m3";      // [r] float64
inline constexpr const char* tet_region = "tet_region";      // [t] int32; absent: all in region 0

// constraints/<name>: nodes
inline constexpr const char* constraints = "constraints";

// compliance/<name>: nodes, payload and these attributes. Dense-tiled: payload [block, scalar].
inline constexpr const char* compliance = "compliance";
inline constexpr const char* payload = "payload";
inline constexpr const char* kind = "kind";
inline constexpr const char* time_step = "time_step_s";
inline constexpr const char* fixed_set = "fixed_set";
inline constexpr const char* mass_factor = "mass_factor";
inline constexpr const char* stiffness_factor = "stiffness_factor";
inline constexpr const char* tolerance_asked = "tolerance_asked";
inline constexpr const char* solve_residual = "error_solve_residual";
inline constexpr const char* scaled_spectral = "error_scaled_spectral";
inline constexpr const char* frobenius = "error_frobenius";
inline constexpr const char* worst_column = "error_worst_column";
inline constexpr const char* representation = "representation";
inline constexpr const char* scalar = "scalar";
inline constexpr const char* node_count = "node_count";
inline constexpr const char* tile_nodes = "tile_nodes";
inline constexpr const char* block_count = "block_count";
inline constexpr const char* block_scalars = "block_scalars";
// New in 1.2; where an attribute is missing: "scaled-spectral", 0, 0.
inline constexpr const char* error_norm = "error_norm";
inline constexpr const char* shift = "shift";
inline constexpr const char* coarsening = "coarsening";
// Of a coarsened variant: one row per entry of `nodes`.
inline constexpr const char* prolongation_rows = "prolongation_rows";        // [m, 4] int32
inline constexpr const char* prolongation_weights = "prolongation_weights";  // [m, 4] float64
// Hierarchical: payload [bytes] uint8, attribute depth, and the members of HierarchicalIndex; lists
// without entries are absent.
inline constexpr const char* depth = "depth";
inline constexpr const char* order = "order";                // [n] int32
inline constexpr const char* scale = "scale";                // [n, 6] float32
inline constexpr const char* leaf_step = "leaf_step";        // [leaves] float32
inline constexpr const char* leaf_planes = "leaf_planes";    // [leaves] uint8
inline constexpr const char* rank = "rank";                  // [leaves - 1] int32
inline constexpr const char* step = "step";                  // [leaves - 1] float32
inline constexpr const char* singular = "singular";          // [terms] float32
inline constexpr const char* planes = "planes";              // [terms] uint8
inline constexpr const char* record_begin = "record_begin";  // [leaves + 1] int64

// Texts of the enumerations, by their value.
inline constexpr std::array<std::string_view, 2> kinds{"dynamic", "static"};
inline constexpr std::array<std::string_view, 2> representations{"dense-tiled", "hierarchical"};
inline constexpr std::array<std::string_view, 2> scalars{"float32", "float64"};
inline constexpr std::array<std::string_view, 3> error_norms{"scaled-spectral", "frobenius",
                                                             "worst-column"};

inline constexpr std::uint64_t smallest_chunk_bytes = 64 << 10;  // smaller pieces are put together
inline constexpr std::uint64_t largest_chunk_bytes = 1 << 20;
// Of records, which are entropy-coded and read one by one: small chunks cost next to nothing and keep
// what is read beside the record small. More chunks than this only of the largest size.
inline constexpr std::uint64_t smallest_record_chunk_bytes = 16 << 10;
inline constexpr std::uint64_t usual_record_chunk_count = 1024;

constexpr std::size_t bytes_of(ScalarType type) { return type == ScalarType::float32 ? 4 : 8; }

}  // namespace souple::layout
