// SPDX-License-Identifier: MIT
#include "runtime/world/driven_nodes.hpp"

#include "runtime/collision/rigid_distance.hpp"
#include "runtime/world/rigid_path.hpp"
#include "runtime/world/soft_body_asset.hpp"

namespace souple {

void DrivenNodes::place(double time_s, std::span<const Point> rest, Eigen::VectorXd& x) const {
  const RigidPlacement at = placement(pose_at(path, time_s));
  for (const Index node : nodes)
    node_entry(x, node) = at.rotation * as_vec3(rest[std::size_t(node)]) + at.translation;
}

Result<std::vector<DrivenNodes>> find_driven_nodes(const SoftBodyDescription& d,
                                                   const SoftBodyAsset& asset,
                                                   const std::vector<char>& is_fixed) {
  constexpr auto code = IssueCode::driven_nodes_invalid;
  std::vector<DrivenNodes> all;
  std::vector<char> is_driven(is_fixed.size(), 0);
  for (const DrivenSet& driven : d.driven) {
    const FixedSet* set = asset.find_fixed_set(driven.name);
    if (!set) return make_issue(code, "the asset has no set \"" + driven.name + "\"", d.name);
    for (const Index node : set->nodes) {
      if (!is_fixed[std::size_t(node)])
        return make_issue(code,
                          "node " + std::to_string(node) + " of \"" + driven.name +
                              "\" is not in the fixed set \"" + d.fixed_set + "\"",
                          d.name);
      if (is_driven[std::size_t(node)]++)
        return make_issue(code, "node " + std::to_string(node) + " is driven twice", d.name);
    }
    if (auto status = check_path(driven.path, code, d.name + ": " + driven.name); !status)
      return status.issue();
    all.push_back({set->nodes, driven.path});
  }
  return all;
}

}  // namespace souple
