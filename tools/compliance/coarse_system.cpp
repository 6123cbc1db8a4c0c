// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "tools/compliance/compliance_system.hpp"

namespace souple {
namespace {

// Below this share of a node the coarse node does not carry the fine one: it would be all but free.
constexpr double least_weight = 1e-6;

/// Up to four coarse nodes that carry a fine one; weight 0 where there are fewer.
struct Carriers {
  std::array<Index, 4> node{};
  std::array<double, 4> weight{};
};

std::vector<Carriers> carriers_of(const MeshLevel& level, const MeshLevel& coarser) {
  std::vector<Carriers> carriers(level.mesh.nodes.size());
  for (std::size_t k = 0; k < carriers.size(); ++k) {
    Carriers& c = carriers[k];
    if (!level.embedding.empty()) {
      c.node = coarser.mesh.tets[std::size_t(level.embedding[k].tet)];
      c.weight = level.embedding[k].weights;
      for (double& weight : c.weight)
        if (std::abs(weight) < least_weight) weight = 0;
    } else {
      const auto [a, b] = level.parents[k];
      c.node = {a, b, a, a};
      c.weight = {a == b ? 1.0 : 0.5, a == b ? 0.0 : 0.5, 0, 0};
    }
  }
  return carriers;
}

Status check_levels(const MeshLevel& level, const MeshLevel& coarser) {
  const auto refuse = [](const std::string& what) {
    return Status(make_issue(IssueCode::recipe_needs_coarser_level, what));
  };
  const std::size_t count = level.mesh.nodes.size();
  if (level.embedding.size() != count && level.parents.size() != count)
    return refuse("the finest level does not say how it hangs on the one below");
  const auto inside = [](Index i, std::size_t size) { return i >= 0 && std::size_t(i) < size; };
  if (!level.embedding.empty()) {
    for (const Embedding& e : level.embedding)
      if (!inside(e.tet, coarser.mesh.tets.size()) ||
          !std::ranges::all_of(e.weights, [](double w) { return std::isfinite(w); }))
        return refuse("the embedding of the finest level does not fit the level below");
    return {};
  }
  for (const auto& [a, b] : level.parents)
    if (!inside(a, coarser.mesh.nodes.size()) || !inside(b, coarser.mesh.nodes.size()))
      return refuse("the parents of the finest level are not nodes of the level below");
  return {};
}

/// For every coarse node the fine ones that it carries, and with what weight.
struct Carried {
  std::vector<std::vector<std::pair<Index, double>>> of;
};

Carried carried_by(const std::vector<Carriers>& carriers, std::span<const Index> free_nodes,
                   std::size_t coarse_count) {
  Carried carried{std::vector<std::vector<std::pair<Index, double>>>(coarse_count)};
  for (const Index node : free_nodes) {
    const Carriers& c = carriers[std::size_t(node)];
    for (std::size_t k = 0; k < 4; ++k)
      if (c.weight[k] != 0) carried.of[std::size_t(c.node[k])].emplace_back(node, c.weight[k]);
  }
  return carried;
}

/// Row `row` of P^T A P: the coarse columns it meets, ascending, each with its block.
class GalerkinRow {
 public:
  explicit GalerkinRow(std::size_t coarse_count) : place_(coarse_count, -1) {}

  void compute(const ComplianceSystem& fine, const std::vector<char>& is_free,
               const std::vector<Carriers>& carriers, const Carried& carried, Index row) {
    for (const Index column : columns) place_[std::size_t(column)] = -1;
    columns.clear();
    blocks.clear();
    for (const auto& [node, weight] : carried.of[std::size_t(row)])
      for (Index b = fine.pattern->row_begin[std::size_t(node)];
           b < fine.pattern->row_begin[std::size_t(node) + 1]; ++b) {
        const auto other = std::size_t(fine.pattern->column[std::size_t(b)]);
        if (is_free[other]) add(carriers[other], weight, fine.a0->block(b));
      }
  }

  std::vector<Index> columns;
  std::vector<Mat3> blocks;

 private:
  void add(const Carriers& other, double weight, const Mat3& block) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (other.weight[k] == 0) continue;
      Index& place = place_[std::size_t(other.node[k])];
      if (place < 0) {
        place = Index(columns.size());
        columns.push_back(other.node[k]);
        blocks.push_back(Mat3::Zero());
      }
      blocks[std::size_t(place)] += weight * other.weight[k] * block;
    }
  }

  std::vector<Index> place_;
};

void build_matrix(const ComplianceSystem& fine, const std::vector<Carriers>& carriers,
                  const Carried& carried, ComplianceSystem& coarse) {
  std::vector<char> is_free(carriers.size(), 0);
  for (const Index node : fine.free_nodes) is_free[std::size_t(node)] = 1;
  const auto count = Index(carried.of.size());
  auto pattern = std::make_unique<BlockPattern>();
  std::vector<double> values;
  pattern->row_begin.push_back(0);
  GalerkinRow row(carried.of.size());
  for (Index node = 0; node < count; ++node) {
    row.compute(fine, is_free, carriers, carried, node);
    std::vector<Index> by_column(row.columns.size());
    for (std::size_t k = 0; k < by_column.size(); ++k) by_column[k] = Index(k);
    std::ranges::sort(by_column, {}, [&](Index k) { return row.columns[std::size_t(k)]; });
    pattern->diagonal.push_back(-1);  // stays so for nodes that carry nothing: they are no unknowns
    for (const Index k : by_column) {
      const Index column = row.columns[std::size_t(k)];
      if (column == node) pattern->diagonal.back() = Index(pattern->column.size());
      pattern->column.push_back(column);
      const BlockMatrix::Block block = row.blocks[std::size_t(k)];
      values.insert(values.end(), block.data(), block.data() + 9);
    }
    pattern->row_begin.push_back(Index(pattern->column.size()));
    if (!row.columns.empty()) coarse.free_nodes.push_back(node);
  }
  coarse.pattern = std::move(pattern);
  coarse.a0 = std::make_unique<BlockMatrix>(*coarse.pattern);
  coarse.a0->values = std::move(values);
}

}  // namespace

Result<CoarseSystem> build_coarse_system(const ComplianceSystem& fine, const MeshLevel& level,
                                         const MeshLevel& coarser) {
  if (auto status = check_levels(level, coarser); !status) return status.issue();
  const auto carriers = carriers_of(level, coarser);
  const Carried carried = carried_by(carriers, fine.free_nodes, coarser.mesh.nodes.size());
  CoarseSystem result;
  ComplianceSystem& coarse = result.system;
  coarse.worst_element = fine.worst_element;
  build_matrix(fine, carriers, carried, coarse);
  std::vector<Index> row_of(coarser.mesh.nodes.size(), -1);
  for (const Index node : fine.nodes)
    for (std::size_t k = 0; k < 4; ++k)
      if (carriers[std::size_t(node)].weight[k] != 0)
        row_of[std::size_t(carriers[std::size_t(node)].node[k])] = 0;
  for (std::size_t k = 0; k < coarse.free_nodes.size(); ++k) {
    const Index node = coarse.free_nodes[k];
    if (row_of[std::size_t(node)] < 0) continue;
    row_of[std::size_t(node)] = Index(coarse.nodes.size());
    coarse.nodes.push_back(node);
    coarse.chosen.push_back(Index(k));
    coarse.positions.push_back(coarser.mesh.nodes[std::size_t(node)]);
  }
  for (const Index node : fine.nodes) {
    const Carriers& c = carriers[std::size_t(node)];
    RowProlongation row;
    const auto first = std::ranges::find_if(c.weight, [](double w) { return w != 0; });
    row.row.fill(row_of[std::size_t(c.node[std::size_t(first - c.weight.begin())])]);
    for (std::size_t k = 0, used = 0; k < 4; ++k) {
      if (c.weight[k] == 0) continue;
      row.row[used] = row_of[std::size_t(c.node[k])];
      row.weight[used++] = c.weight[k];
    }
    result.prolongation.push_back(row);
  }
  return result;
}

}  // namespace souple
