// SPDX-License-Identifier: MIT
#include "runtime/multigrid/level_transitions.hpp"

#include <utility>

#include "runtime/multigrid/row_products.hpp"

namespace souple {

Result<std::vector<LevelTransition>> store_transitions(std::span<const MeshLevel> levels) {
  std::vector<LevelTransition> transitions;
  if (levels.size() < 2) return transitions;
  transitions.resize(levels.size() - 1);
  const TetMesh& finest = levels.back().mesh;
  for (const Tet& tet : finest.tets)
    for (const Index node : tet)
      if (node < 0 || static_cast<std::size_t>(node) >= finest.nodes.size())
        return make_issue(IssueCode::asset_index_out_of_range,
                          "a tet of the finest level names node " + std::to_string(node));
  BlockPattern pattern = build_block_pattern(static_cast<Index>(finest.nodes.size()), finest.tets);
  for (std::size_t l = levels.size() - 1; l > 0; --l) {
    Result<Prolongation> p = prolongation_of(levels[l], levels[l - 1]);
    if (!p) return p.issue();
    RowProductsPlan plan = plan_row_products(pattern, *p);
    LevelTransition& stored = transitions[l - 1];
    plan.products.store(stored);
    stored.row_begin = std::move(p->row_begin);
    stored.column = std::move(p->column);
    stored.weight = std::move(p->weight);
    stored.pattern_begin = plan.pattern.row_begin;
    stored.pattern_column = plan.pattern.column;
    pattern = std::move(plan.pattern);
  }
  return transitions;
}

}  // namespace souple
