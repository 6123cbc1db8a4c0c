// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "formats/core/solver_kind.hpp"
#include "runtime/collision/surface_tree.hpp"
#include "runtime/compliance/rest_compliance.hpp"
#include "runtime/compliance/rest_extension.hpp"
#include "runtime/compliance/rigid_modes.hpp"
#include "runtime/fem/corotational_model.hpp"
#include "runtime/visual/visual_surface.hpp"

namespace souple {

/// One compliance of a body, ready for use.
struct BodyCompliance {
  ComplianceHeader header;
  std::vector<Index> nodes;        ///< mesh node of every row
  std::vector<Index> row_of_node;  ///< row of every mesh node, -1: not held
  std::unique_ptr<const RestCompliance> rest;
  RestExtension extension;
};

/// What a body is made from. Blocks come through a BlockSource, so that this does not know files.
struct SoftBodyContent {
  MeshLevel level;    ///< the one that is simulated; what ties it to coarser levels is not used
  VisualMesh visual;  ///< empty: none
  Material material;
  std::vector<FixedSet> fixed_sets;
  /// For multigrid: [l - 1] from level l to level l - 1, and the rest positions of level 0, m, which is
  /// coarsened further where it is too large. Empty: not there, or not asked for.
  std::vector<LevelTransition> multigrid{};
  std::vector<Point> coarsest_nodes{};
  SolverKind default_solver = SolverKind::automatic;  ///< as recorded; automatic: by the node count
  struct Variant {
    ComplianceHeader header;
    std::vector<Index> nodes;
    std::unique_ptr<BlockSource> source;
    std::vector<RowProlongation> prolongation{};  ///< one row per node if coarsened, else empty
    HierarchicalIndex hierarchy{};                ///< of the hierarchical representation
  };
  std::vector<Variant> compliances;
  /// Of memory for tables that make contacts fast (PairTable), in all; the first compliances get them.
  std::size_t table_bytes = 0;
};

/// A baked body in memory: const, shared by any number of instances.
class SoftBodyAsset {
 public:
  /// Issues: mesh_element_invalid, material_out_of_range, fixed_set_invalid, asset_corrupt,
  /// compliance_factorisation_failed, asset_embedding_invalid, asset_index_out_of_range.
  static Result<std::shared_ptr<const SoftBodyAsset>> create(SoftBodyContent content);

  const CorotationalModel& model() const { return model_; }
  const SurfaceTree& surface() const { return surface_; }
  const RigidModes& rigid_modes() const { return rigid_modes_; }
  std::span<const FixedSet> fixed_sets() const { return fixed_sets_; }
  const FixedSet* find_fixed_set(const std::string& name) const;
  /// As in SoftBodyContent; GalerkinPlan::open checks what it is given.
  std::span<const LevelTransition> multigrid() const { return multigrid_; }
  std::span<const Point> coarsest_nodes() const { return coarsest_nodes_; }
  std::span<const BodyCompliance> compliances() const { return compliances_; }
  /// The compliance of A0 = mass_factor M + stiffness_factor K with this fixed set, up to a factor
  /// (METHOD 4.2: the ratio of the factors is the key); nullptr if there is none.
  const BodyCompliance* find_compliance(double mass_factor, double stiffness_factor,
                                        const std::string& fixed_set) const;
  /// What its steps are best begun with: as recorded, else by the number of nodes. See StepSolver for
  /// what is done where that goes badly.
  SolverKind default_solver() const;
  /// The surface to be shown; nullptr unless there was one and it was asked for. For an instance:
  /// `asset.visual()->positions(world.positions(body), vertices)`.
  const VisualSurface* visual() const { return visual_ ? &*visual_ : nullptr; }
  double longest_side_m() const { return longest_side_; }
  std::size_t resident_bytes() const;

 private:
  explicit SoftBodyAsset(CorotationalModel model) : model_(std::move(model)) {}
  Status add_visual(const VisualMesh& visual);
  Status add_compliance(SoftBodyContent::Variant variant, std::size_t table_bytes);

  CorotationalModel model_;
  SurfaceTree surface_;
  RigidModes rigid_modes_;
  std::vector<FixedSet> fixed_sets_;
  std::vector<LevelTransition> multigrid_;
  std::vector<Point> coarsest_nodes_;
  std::vector<BodyCompliance> compliances_;
  std::optional<VisualSurface> visual_;
  double longest_side_ = 0;
  SolverKind recorded_solver_ = SolverKind::automatic;
};

}  // namespace souple
