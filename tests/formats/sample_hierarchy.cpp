// SPDX-License-Identifier: MIT
#include "sample_hierarchy.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace souple::test {
namespace {

// Planes that any 32-bit integer fits: whatever bytes a record holds, it can be decoded.
constexpr std::uint8_t any_integer = 4;

/// Deterministic on every platform, unlike the distributions of the standard library.
class Noise {
 public:
  explicit Noise(unsigned seed) : random_(seed) {}
  std::uint32_t below(std::uint32_t bound) { return static_cast<std::uint32_t>(random_()) % bound; }
  /// Small numbers of either sign, large ones seldom.
  std::byte byte() {
    const std::uint32_t sum = below(32) + below(32) + below(32);
    return static_cast<std::byte>(sum + 256 - 46);
  }

 private:
  std::mt19937 random_;
};

std::vector<Index> shuffled_rows(Index count, Noise& noise) {
  std::vector<Index> order(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Index>(i);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[noise.below(static_cast<std::uint32_t>(i))]);
  return order;
}

void add_blocks(Index node_count, Index rank, HierarchicalIndex& index) {
  for (int depth = 0; depth < index.depth; ++depth)
    for (Index i = 0; i < (Index{1} << depth); ++i) {
      const Index smaller = std::min(cluster_range(node_count, depth + 1, 2 * i).size(),
                                     cluster_range(node_count, depth + 1, 2 * i + 1).size());
      index.rank.push_back(std::min(rank, 3 * smaller));
      index.step.push_back(1e-7F * static_cast<float>(1 + i % 3));
      for (Index k = 0; k < index.rank.back(); ++k) {
        index.singular.push_back(std::ldexp(1.0F, -static_cast<int>(k % 16)));
        index.planes.push_back(any_integer);
      }
    }
}

/// A byte per integer, about.
void add_records(Index node_count, HierarchicalIndex& index) {
  index.record_begin = {0};
  for (Index leaf = 0; leaf < (Index{1} << index.depth); ++leaf)
    index.record_begin.push_back(index.record_begin.back() + record_bytes(index, node_count, leaf) / 5);
}

void set_dynamic(const Asset& asset, ComplianceHeader& header) {
  constexpr double h = 0.01;
  header.kind = ComplianceKind::dynamic_step;
  header.time_step_s = h;
  header.mass_factor = 1 / (h * h) + asset.material.rayleigh_mass_per_s / h;
  header.stiffness_factor = 1 + asset.material.rayleigh_stiffness_s / h;
}

void set_hierarchy(MadeUpHierarchy hierarchy, ComplianceVariant& variant) {
  ComplianceHeader& header = variant.header;
  header.representation = ComplianceRepresentation::hierarchical;
  header.node_count = static_cast<std::int64_t>(hierarchy.index.order.size());
  header.block_count = static_cast<std::int64_t>(hierarchy.index.leaf_step.size());
  header.tolerance_asked = 1e-3;
  header.error = {2e-12, 4.5e-4, 2.5e-4, 8.5e-4};
  header.shift = 4.5e-4;
  variant.hierarchy = std::move(hierarchy.index);
  variant.payload = std::move(hierarchy.payload);
}

/// The row of the prolongation that carries the coarser level to a node.
RowProlongation row_of(const MeshLevel& fine, const MeshLevel& coarse, std::size_t node) {
  RowProlongation row;
  if (!fine.embedding.empty()) {
    row.row = coarse.mesh.tets[static_cast<std::size_t>(fine.embedding[node].tet)];
    row.weight = fine.embedding[node].weights;
    return row;
  }
  const auto [a, b] = fine.parents[node];
  row.row = {a, b, a, a};
  row.weight = a == b ? std::array<double, 4>{1, 0, 0, 0} : std::array<double, 4>{0.5, 0.5, 0, 0};
  return row;
}

}  // namespace

MadeUpHierarchy make_hierarchy(Index node_count, int depth, Index rank) {
  Noise noise(static_cast<unsigned>(node_count));
  MadeUpHierarchy made;
  HierarchicalIndex& index = made.index;
  index.depth = depth;
  index.order = shuffled_rows(node_count, noise);
  for (Index row = 0; row < node_count; ++row) {
    const float size = 0.01F + 0.0001F * static_cast<float>(noise.below(100));
    index.scale.push_back({size, 0.1F * size, 1.25F * size, 0, -0.1F * size, 0.5F * size});
  }
  for (Index leaf = 0; leaf < (Index{1} << depth); ++leaf) {
    index.leaf_step.push_back(1e-5F * static_cast<float>(1 + leaf % 3));
    index.leaf_planes.push_back(any_integer);
  }
  add_blocks(node_count, rank, index);
  add_records(node_count, index);
  made.payload.resize(static_cast<std::size_t>(index.record_begin.back()));
  std::ranges::generate(made.payload, [&] { return noise.byte(); });
  return made;
}

ComplianceVariant make_hierarchical_variant(const Asset& asset, int depth, Index rank) {
  ComplianceVariant variant;
  variant.header.name = "compressed";
  variant.nodes = used_nodes(asset.levels.back().boundary);
  set_dynamic(asset, variant.header);
  set_hierarchy(make_hierarchy(static_cast<Index>(variant.nodes.size()), depth, rank), variant);
  variant.header.error_norm = ErrorNorm::frobenius;
  return variant;
}

ComplianceVariant make_coarse_variant(const Asset& asset) {
  const MeshLevel& fine = asset.levels.back();
  const MeshLevel& coarse = asset.levels[asset.levels.size() - 2];
  ComplianceVariant variant;
  variant.header.name = "coarse";
  variant.nodes = used_nodes(fine.boundary);
  for (const Index node : variant.nodes)
    variant.prolongation.push_back(row_of(fine, coarse, static_cast<std::size_t>(node)));
  set_dynamic(asset, variant.header);
  set_hierarchy(make_hierarchy(static_cast<Index>(coarse.mesh.nodes.size()), 1, 3), variant);
  variant.header.coarsening = 1;
  variant.header.error_norm = ErrorNorm::worst_column;
  return variant;
}

}  // namespace souple::test
