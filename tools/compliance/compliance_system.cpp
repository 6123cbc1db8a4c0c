// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/compliance_system.hpp"

#include <algorithm>

#include "runtime/fem/corotational_model.hpp"
#include "tools/compliance/check_support.hpp"

namespace souple {
namespace {

Issue empty_region(const std::string& what) {
  return make_issue(IssueCode::compliance_region_empty, what);
}

Status check_touched(std::span<const Index> touched, std::size_t node_count) {
  for (std::size_t k = 0; k < touched.size(); ++k)
    if (touched[k] < 0 || std::size_t(touched[k]) >= node_count ||
        (k > 0 && touched[k] <= touched[k - 1]))
      return empty_region("the nodes that can be touched do not ascend within the mesh");
  return {};
}

}  // namespace

Result<ComplianceSystem> build_system(PreparedBody& body, const FixedSet* fixed,
                                      std::span<const Index> touched, double mass_factor,
                                      double stiffness_factor) {
  const MeshLevel& level = body.level();
  const std::size_t node_count = level.mesh.nodes.size();
  if (auto status = check_touched(touched, node_count); !status) return status.issue();
  if (fixed)
    if (auto status = check_fixed_set(*fixed, node_count); !status) return status.issue();
  const auto made = body.model();
  if (!made) return made.issue();
  const CorotationalModel* model = *made;
  ComplianceSystem system;
  system.pattern = std::make_unique<BlockPattern>(model->pattern());
  system.a0 = std::make_unique<BlockMatrix>(*system.pattern);
  model->assemble_rest(mass_factor, stiffness_factor, *system.a0);
  system.worst_element = "worst element: tet " + std::to_string(model->worst_element());
  for (Index node = 0; node < Index(node_count); ++node)
    if (!fixed || !std::ranges::binary_search(fixed->nodes, node)) system.free_nodes.push_back(node);
  for (const Index node : used_nodes(level.boundary)) {
    if (!touched.empty() && !std::ranges::binary_search(touched, node)) continue;
    const auto place = std::ranges::lower_bound(system.free_nodes, node);
    if (place == system.free_nodes.end() || *place != node) continue;
    system.nodes.push_back(node);
    system.chosen.push_back(Index(place - system.free_nodes.begin()));
    system.positions.push_back(level.mesh.nodes[std::size_t(node)]);
  }
  if (system.nodes.empty()) return empty_region("no surface node that can be touched may move");
  return system;
}

}  // namespace souple
