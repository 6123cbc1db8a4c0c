// SPDX-License-Identifier: MIT
#include "runtime/world/soft_body_asset.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/compliance/open_variant.hpp"

namespace souple {
namespace {

// Two time steps count as one if their ratios of factors agree to this.
constexpr double ratio_tolerance = 1e-9;

Status check_nodes(std::span<const Index> nodes, Index node_count, IssueCode code,
                   const std::string& where) {
  for (std::size_t k = 0; k < nodes.size(); ++k)
    if (nodes[k] < 0 || nodes[k] >= node_count || (k > 0 && nodes[k] <= nodes[k - 1]))
      return make_issue(code, "node indices do not ascend within the mesh", where);
  return {};
}

Status check_boundary(std::span<const Triangle> boundary, Index node_count) {
  for (const auto& triangle : boundary)
    for (const Index node : triangle)
      if (node < 0 || node >= node_count)
        return make_issue(IssueCode::mesh_element_invalid,
                          "a boundary triangle names node " + std::to_string(node));
  return {};
}

}  // namespace

Result<std::shared_ptr<const SoftBodyAsset>> SoftBodyAsset::create(SoftBodyContent content) {
  auto model = CorotationalModel::create(content.level.mesh, content.material);
  if (!model) return model.issue();
  std::shared_ptr<SoftBodyAsset> asset(new SoftBodyAsset(std::move(*model)));
  const Index node_count = asset->model_.node_count();
  if (auto status = check_boundary(content.level.boundary, node_count); !status) return status.issue();
  for (const auto& set : content.fixed_sets)
    if (auto status = check_nodes(set.nodes, node_count, IssueCode::fixed_set_invalid, set.name);
        !status)
      return status.issue();
  if (auto status = asset->add_visual(content.visual); !status) return status.issue();
  asset->surface_ = SurfaceTree(asset->model_.rest_positions(), std::move(content.level.boundary));
  asset->rigid_modes_ = RigidModes(asset->model_.rest_positions(), asset->model_.masses());
  asset->fixed_sets_ = std::move(content.fixed_sets);
  asset->multigrid_ = std::move(content.multigrid);
  asset->recorded_solver_ = content.default_solver;
  asset->coarsest_nodes_ = std::move(content.coarsest_nodes);
  Eigen::AlignedBox3d box;
  for (const auto& node : asset->model_.rest_positions()) box.extend(Vec3(as_vec3(node)));
  asset->longest_side_ = box.sizes().maxCoeff();
  std::size_t table_bytes = content.table_bytes;
  for (auto& variant : content.compliances) {
    if (auto status = asset->add_compliance(std::move(variant), table_bytes); !status)
      return status.issue();
    table_bytes -= asset->compliances_.back().rest->table_bytes();
  }
  return std::shared_ptr<const SoftBodyAsset>(std::move(asset));
}

Status SoftBodyAsset::add_visual(const VisualMesh& visual) {
  if (visual.surface.vertices.empty()) return {};
  auto surface =
      VisualSurface::create(visual, model_.tets(), static_cast<std::size_t>(model_.node_count()));
  if (!surface) return surface.issue();
  visual_ = std::move(*surface);
  return {};
}

Status SoftBodyAsset::add_compliance(SoftBodyContent::Variant variant, std::size_t table_bytes) {
  const std::string where = "compliance/" + variant.header.name;
  const Index node_count = model_.node_count();
  if (auto s = check_nodes(variant.nodes, node_count, IssueCode::asset_corrupt, where); !s) return s;
  const bool prolonged = variant.header.coarsening != 0;
  if (prolonged ? variant.prolongation.size() != variant.nodes.size()
                : std::int64_t(variant.nodes.size()) != variant.header.node_count)
    return make_issue(IssueCode::asset_corrupt, "node list and header disagree", where);
  std::span<const Index> fixed;
  if (!variant.header.fixed_set.empty()) {
    const FixedSet* set = find_fixed_set(variant.header.fixed_set);
    if (!set)
      return make_issue(IssueCode::asset_corrupt,
                        "fixed set \"" + variant.header.fixed_set + "\" is missing", where);
    fixed = set->nodes;
  }
  auto rest = open_variant(variant.header, variant.hierarchy, std::move(variant.prolongation),
                           std::move(variant.source), table_bytes);
  if (!rest) return rest.issue();
  auto extension = RestExtension::create(model_, variant.header.mass_factor,
                                         variant.header.stiffness_factor, variant.nodes, fixed);
  if (!extension) return extension.issue();
  BodyCompliance body{
      std::move(variant.header), std::move(variant.nodes), {}, std::move(*rest), std::move(*extension)};
  body.row_of_node.assign(node_count, -1);
  for (std::size_t row = 0; row < body.nodes.size(); ++row)
    body.row_of_node[body.nodes[row]] = static_cast<Index>(row);
  compliances_.push_back(std::move(body));
  return {};
}

const FixedSet* SoftBodyAsset::find_fixed_set(const std::string& name) const {
  const auto found = std::ranges::find(fixed_sets_, name, &FixedSet::name);
  return found == fixed_sets_.end() ? nullptr : &*found;
}

const BodyCompliance* SoftBodyAsset::find_compliance(double mass_factor, double stiffness_factor,
                                                     const std::string& fixed_set) const {
  for (const auto& compliance : compliances_) {
    const double asked = mass_factor / stiffness_factor;
    const double held = compliance.header.mass_factor / compliance.header.stiffness_factor;
    if (compliance.header.fixed_set == fixed_set && std::abs(asked - held) <= ratio_tolerance * asked)
      return &compliance;
  }
  return nullptr;
}

SolverKind SoftBodyAsset::default_solver() const {
  if (recorded_solver_ != SolverKind::automatic) return recorded_solver_;
  // The factor of the rest matrix grows with the power 4/3 of the nodes, a V-cycle with the nodes.
  constexpr Index largest_factor_nodes = 6000;
  return model_.node_count() <= largest_factor_nodes ? SolverKind::warped_pcg
                                                     : SolverKind::multigrid_pcg;
}

std::size_t SoftBodyAsset::resident_bytes() const {
  std::size_t bytes = model_.bytes() + surface_.bytes() + (visual_ ? visual_->bytes() : 0);
  bytes += coarsest_nodes_.size() * sizeof(Point);
  for (const LevelTransition& t : multigrid_)
    bytes += (t.row_begin.size() + t.column.size() + t.pattern_begin.size() + t.pattern_column.size() +
              4 * (t.pieces.size() + t.targets.size())) *
                 sizeof(Index) +
             t.weight.size() * sizeof(double) + 4 * t.slots.size();
  for (const auto& c : compliances_)
    bytes += c.rest->resident_bytes() + c.extension.resident_bytes() +
             (c.nodes.size() + c.row_of_node.size()) * sizeof(Index);
  return bytes;
}

}  // namespace souple
