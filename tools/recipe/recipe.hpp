// SPDX-License-Identifier: GPL-3.0-or-later
// What to bake: a surface, a resolution, a material, fixed sets and compliances. Plain data with the
// defaults of a soft organ; SI units.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct SurfaceSettings {
  std::filesystem::path file;  ///< a surface or a tet mesh
  std::string unit = "m";      ///< of the numbers in the file
  double size_m = 0;           ///< longest side after scaling; 0: the file's own size
  /// "auto", "mend" (never wrap; turn inverted and drop flat tets), "wrap", "off" (refuse instead).
  std::string repair = "auto";
};

struct MeshSettings {
  std::int64_t tets = 0;     ///< about so many on the finest level; 0: chosen by chosen_tets
  double edge_length_m = 0;  ///< > 0: edge length of the finest level, instead of a count
  double max_error_m = 0;    ///< > 0: the finest boundary stays within this distance of the surface
  std::int64_t levels = 0;   ///< 0: chosen by chosen_levels
  std::string hierarchy = "nested";
  std::string diagonal = "quality";  ///< of red refinement: "quality", "shortest", "fixed"
  std::string fit = "projection";    ///< "projection", "least_squares", "nearest_three", "none"
  std::string mesher = "auto";       ///< "auto", "delaunay", "lattice"
  std::string features = "auto";     ///< sharp edges: "auto", "keep", "ignore"
  double interior_coarsening = 1;    ///< edge deep inside over edge at the surface
  std::string visual = "original";   ///< the surface stored for display: "original", "none"
};

struct MaterialSettings {
  double young_pa = 1e4;
  double poisson = 0.4;
  double density_kg_m3 = 1000;
  double rayleigh_mass_per_s = 0.1;
  double rayleigh_stiffness_s = 0.01;
};

// Selections of nodes, in metres and in the frame of the final mesh: the coordinates of the surface
// file times the scale to metres and to the target size. Borders belong to the selection.
struct BoxSelection {
  Point min{}, max{};
};
struct SphereSelection {
  Point centre{};
  double radius_m = 0;
};
/// All nodes x with normal . (x - point) <= distance_m: those below the plane.
struct PlaneSelection {
  Point point{};
  Point normal{};  ///< of any length
  double distance_m = 0;
};
/// The `count` nodes nearest to a point; the lower index wins a tie.
struct NearestSelection {
  Point point{};
  std::int64_t count = 1;
};
using NodeSelection = std::variant<BoxSelection, SphereSelection, PlaneSelection, NearestSelection>;

/// A surface in a file of its own, in the unit of the main one and scaled with it.
struct FileSelection {
  std::filesystem::path file;
};

/// The tets that a given tet mesh labels so (physical group, reference, attribute).
struct GroupSelection {
  std::string name;
};

/// `[[mesh.refine]]`: an edge length of its own in a part of the body.
struct RefineRequest {
  double edge_length_m = 0;
  /// Where; with distance_m > 0 all that is nearer than it to the piece of the surface in there.
  std::variant<BoxSelection, SphereSelection, FileSelection> where;
  double distance_m = 0;
};

/// `[[material.region]]`: another material where the middle of a tet lies inside; later ones win.
struct RegionRequest {
  std::string name;
  double young_pa = 0;
  double poisson = 0;
  double density_kg_m3 = 0;
  std::variant<BoxSelection, SphereSelection, FileSelection, GroupSelection> where;
};

struct FixedRequest {
  std::string name;
  NodeSelection selection;
};

struct ComplianceRequest {
  std::string name = "default";
  ComplianceKind kind = ComplianceKind::dynamic_step;
  double time_step_s = 0.01;  ///< 0 if static
  /// "implicit_euler", or "bdf2", whose system is that of implicit Euler with two thirds of the step;
  /// the asset states that step.
  std::string integrator = "implicit_euler";
  std::string fixed;  ///< name of a fixed set; empty: none
  /// Largest error of what is stored, measured in `error_norm`; 0: dense, exact to `scalar`.
  double tolerance = 1e-3;
  std::string error_norm = "scaled-spectral";  ///< "scaled-spectral", "frobenius", "worst-column"
  ScalarType scalar = ScalarType::float32;     ///< of the dense form; means nothing for the other
  std::optional<NodeSelection> nodes;          ///< where the body can be touched; none: everywhere
  std::int64_t coarsening = 0;                 ///< 1: the compliance of the level below
  std::string way = "auto";                    ///< "auto", "dense", "by-solves"
};

/// The step of implicit Euler that has the system of this request; 0 if static.
double euler_step(const ComplianceRequest& request);

struct Recipe {
  SurfaceSettings surface;
  MeshSettings mesh;
  MaterialSettings material;
  std::vector<RefineRequest> refine;
  std::vector<RegionRequest> regions;
  std::vector<FixedRequest> fixed;
  std::vector<ComplianceRequest> compliances{ComplianceRequest{}};
};

/// Every key is known, of its kind and in range, or the recipe is refused. Keys that are absent keep
/// their default. `name` stands in messages. Issues: config_*, usage_conflict, unsupported_feature.
Result<Recipe> parse_recipe(std::string_view text, const std::string& name);
/// As parse_recipe; relative files are taken relative to the recipe's folder. Keys that are absent keep
/// the value that `base` has.
Result<Recipe> read_recipe(const std::filesystem::path& file, const Recipe& base = {});

/// What the keys must agree on among themselves, after command-line options were applied.
/// Issues: usage_missing_argument, usage_conflict, config_bad_value, recipe_too_few_tets,
/// recipe_needs_coarser_level, recipe_same_compliance, compliance_singular, unsupported_feature.
Status check_recipe(const Recipe& recipe);

/// What the compliances must agree on among themselves and with a body of `level_count` levels and
/// fixed sets of these names. check_recipe asks for it too. Issues: those of check_recipe.
Status check_compliances(const std::vector<ComplianceRequest>& compliances, std::int64_t level_count,
                         const std::vector<std::string>& fixed_sets);

inline constexpr std::int64_t default_tets = 10000;

/// Whether the file is a tet mesh (by its extension) that is taken as it is: no count, edge length or
/// largest error was asked for. With one of them its boundary is meshed again.
bool keeps_given_tets(const Recipe& recipe);

/// The tets of the finest level: those asked for, or else 10000; 0 where an edge length, a largest
/// error or a given mesh decides.
std::int64_t chosen_tets(const Recipe& recipe);

/// The levels of the hierarchy: those asked for, or else two where the coarser one keeps enough tets to
/// hold the shape (dino.off and anchor.off lose limbs below about 1000), and one where it would not. A
/// given tet mesh is not refined unless asked for.
std::int64_t chosen_levels(const Recipe& recipe);

/// The effective recipe as TOML, every key written: the same text for the same recipe, wherever it was
/// read from (the surface's folder is left out). parse_recipe reads it back.
std::string canonical_recipe_text(const Recipe& recipe);

/// `box = { … }` and the like, as in a recipe.
std::string node_selection_text(const NodeSelection& selection);

}  // namespace souple
