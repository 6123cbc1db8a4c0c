// SPDX-License-Identifier: MIT
// The logical content of an asset file (`*.souple`), version 1.3, as plain structs.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/core/hierarchical_compliance.hpp"
#include "formats/core/mesh.hpp"
#include "formats/core/solver_kind.hpp"

namespace souple {

inline constexpr int asset_version_major = 1;
inline constexpr int asset_version_minor = 3;

/// Where a point sits in a tet mesh: x = sum_k weights[k] x_k over the four nodes of `tet`. The weights
/// sum to 1; outside the tet some are negative (linear extrapolation), so affine motions are exact.
struct Embedding {
  Index tet = 0;
  std::array<double, 4> weights{};
};

/// How well the prolongation P of a level carries rotations: the root mean square over nodes of
/// |P r_coarse - r_fine| over that of |r_fine|, r the infinitesimal rotation about the centroid, worst
/// axis. Translations are exact. Dimensionless; -1: not measured.
struct RigidMotionError {
  double parents = -1;    ///< weights 1 and 1/2 of the parents; -1 for an embedded level
  double embedding = -1;  ///< barycentric weights of the embedding
};

/// One level of the hierarchy: `mesh/levels/<l>`, l = 0 coarsest. A finer level hangs on the coarser
/// one by parents (nested), by an embedding (embedded), or by both: a nested level whose midpoints were
/// moved has an embedding that corrects its P.
struct MeshLevel {
  TetMesh mesh;                    ///< rest shape, metres
  std::vector<Triangle> boundary;  ///< outward
  /// Empty at level 0 and on embedded levels. Else one pair per node: {i, i} keeps node i of the
  /// coarser level, {a, b} is the midpoint of its edge (a, b): row of the prolongation with weight 1,
  /// or 1/2 and 1/2.
  std::vector<std::array<Index, 2>> parents;
  /// Empty at level 0. Else empty or one row per node: its place in the coarser level.
  std::vector<Embedding> embedding;
  RigidMotionError rigid_motion_error;
};

/// The surface to be shown, bound to the finest level: `mesh/visual`.
struct VisualMesh {
  TriangleMesh surface;              ///< rest shape, metres; empty: the asset has none
  std::vector<Embedding> embedding;  ///< one row per vertex, in the finest level
};

struct MaterialRegion {
  std::string name;
  double young_pa = 1e4;          ///< E > 0
  double poisson = 0.4;           ///< in (-1, 0.5)
  double density_kg_m3 = 1000.0;  ///< > 0
};

struct Material {
  std::vector<MaterialRegion> regions;  ///< at least one
  /// Region of every tet of the finest level; empty: all tets in region 0.
  std::vector<Index> tet_region;
  double rayleigh_mass_per_s = 0.1;    ///< alpha of B = alpha M + beta K, >= 0
  double rayleigh_stiffness_s = 0.01;  ///< beta, >= 0
};

/// A named set of nodes of the finest level that a scene may hold fixed: `constraints/<name>`.
struct FixedSet {
  std::string name;
  std::vector<Index> nodes;  ///< sorted, unique, not empty, not all
};

enum class ComplianceKind : std::uint8_t { dynamic_step, static_equilibrium };

/// How the bytes of a variant are to be read. Names in the file: "dense-tiled", "hierarchical".
enum class ComplianceRepresentation : std::uint8_t {
  /// Lower block triangle of the symmetric 3n x 3n matrix in square tiles of `tile_nodes` nodes.
  /// Block b = I (I + 1) / 2 + J holds tile (I, J), J <= I, row-major; diagonal tiles are stored whole,
  /// rows and columns past n are zero. Every block has (3 tile_nodes)^2 scalars.
  dense_tiled,
  /// Low-rank off-diagonal blocks over a cluster tree, quantised (hierarchical_compliance.hpp); the
  /// payload is the leaves' records. New in 1.2.
  hierarchical,
};

/// Which measured error the tolerance of a compressed compliance bounds. Names in the file:
/// "scaled-spectral", "frobenius", "worst-column".
enum class ErrorNorm : std::uint8_t { scaled_spectral, frobenius, worst_column };

enum class ScalarType : std::uint8_t { float32, float64 };

/// What was measured of a stored compliance C~ against the computed C. All relative, dimensionless.
struct ComplianceError {
  double solve_residual =
      0;  ///< of random probes: ||A0 C f - f||_2 / ||f||_2, in double, before storing
  double scaled_spectral = 0;  ///< ||D^-1/2 (C - C~) D^-1/2||_2, D the 3x3 diagonal blocks of C
  double frobenius = 0;        ///< ||C - C~||_F / ||C||_F
  double worst_column = 0;     ///< max over columns of ||(C - C~) e_j||_2 / ||C e_j||_2
};

/// Attributes of `compliance/<name>`: for what it was made and how exact it is; no bulk data.
struct ComplianceHeader {
  std::string name;
  ComplianceKind kind = ComplianceKind::dynamic_step;
  double time_step_s = 0;  ///< > 0 if dynamic, 0 if static
  std::string fixed_set;   ///< empty: none (dynamic only)
  /// C0 = (mass_factor M + stiffness_factor K)^-1 with the fixed nodes removed:
  /// 1/h^2 + alpha/h and 1 + beta/h (dynamic), 0 and 1 (static).
  double mass_factor = 0;
  double stiffness_factor = 1;
  double tolerance_asked = 0;                         ///< 0: exact to the scalar type
  ErrorNorm error_norm = ErrorNorm::scaled_spectral;  ///< what the tolerance bounds
  ComplianceError error;
  ComplianceRepresentation representation = ComplianceRepresentation::dense_tiled;
  ScalarType scalar = ScalarType::float32;
  std::int64_t node_count = 0;     ///< n: nodes (rows of 3) that are stored
  std::int64_t tile_nodes = 0;     ///< dense_tiled only, else 0
  std::int64_t block_count = 0;    ///< dense_tiled: tiles; hierarchical: leaves
  std::int64_t block_scalars = 0;  ///< dense_tiled: scalars per block; else 0
  /// hierarchical only: shift S S^T (S of the index; D for the scaled-spectral norm) is added, the
  /// measured error, so that the compliance stays positive semi-definite.
  double shift = 0;
  /// 0: the nodes are the finest level's own. 1: the stored rows are nodes of the level below, and the
  /// variant's prolongation carries them to the finest level.
  std::int64_t coarsening = 0;
};

/// A finest-level node of a coarse compliance: u = sum_k weight[k] u_row[k].
struct RowProlongation {
  std::array<Index, 4> row{};  ///< stored rows; unused ones repeat the first with weight 0
  std::array<double, 4> weight{};
};

struct ComplianceVariant {
  ComplianceHeader header;
  std::vector<Index> nodes;  ///< finest-level nodes, ascending; size n unless coarsened
  std::vector<RowProlongation> prolongation;  ///< empty, or of every one of `nodes` (coarsening 1)
  HierarchicalIndex hierarchy;                ///< hierarchical only
  /// dense_tiled: blocks one after another, little-endian scalars, m/N; hierarchical: the records.
  std::vector<std::byte> payload;
};

/// How the matrix A of a level gets to the level below it, P^T A P: `multigrid/<l>`, l the finer one.
/// New in 1.3. What the levels say, prepared for a simulation that then needs neither their ties nor
/// their meshes; of the body without fixed nodes.
struct LevelTransition {
  /// P by node of the finer level: scalar weights, times the 3x3 identity for motions.
  std::vector<Index> row_begin;  ///< [m + 1]
  std::vector<Index> column;     ///< node of the coarser level, ascending in a row, 1 to 4 of them
  std::vector<double> weight;    ///< they sum to 1
  /// Where the 3x3 blocks of the coarse matrix stand, both halves, columns ascending in a row.
  std::vector<Index> pattern_begin;   ///< [n + 1]
  std::vector<Index> pattern_column;  ///< node of the coarser level

  static constexpr std::size_t width = 4;  ///< of a row of P, filled up with its first column, weight 0
  /// The plan of the product, piece by piece: {row i of A, position of its first block, number of
  /// blocks, number of slots}. Blocks are those on and right of the diagonal, on the pattern of the
  /// finer level: of its mesh if it is the finest, else of the transition above. Rows ascend.
  std::vector<std::array<Index, 4>> pieces;
  /// Of every block (i, j) and weight of row j of P: the slot of the piece that it is added to.
  std::vector<std::array<std::uint8_t, width>> slots;
  /// Of every slot and weight of row i of P: position of the coarse block that it is added to.
  std::vector<std::array<Index, width>> targets;

  bool operator==(const LevelTransition&) const = default;
};

struct Provenance {
  std::string generator;   ///< "souple 0.1.0"
  std::string recipe;      ///< effective recipe, TOML text
  std::string input_name;  ///< file name of the surface, without folders
  std::string input_hash;  ///< hex of the input's bytes
};

struct Asset {
  std::vector<MeshLevel> levels;           ///< at least one; the last is the one that is simulated
  std::vector<LevelTransition> multigrid;  ///< empty, or [l - 1] from level l to level l - 1
  VisualMesh visual;                       ///< may be empty
  Material material;
  std::vector<FixedSet> fixed_sets;
  std::vector<ComplianceVariant> compliances;
  Provenance provenance;
  /// What steps of the body are best begun with, by counted work; automatic: not recorded. New in 1.3.
  SolverKind default_solver = SolverKind::automatic;
};

}  // namespace souple
