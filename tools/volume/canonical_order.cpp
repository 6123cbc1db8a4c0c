// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/canonical_order.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace souple {
namespace {

/// Interleaves the bits of 3 x 21-bit coordinates: nodes near in space become near in memory.
std::uint64_t morton_code(const Point& unit) {
  std::uint64_t code = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double cell = std::clamp((unit[k] + 0.5) * 0x1p21, 0.0, 0x1p21 - 1);
    const auto bits = static_cast<std::uint64_t>(cell);
    for (unsigned b = 0; b < 21; ++b) code |= ((bits >> b) & 1) << (3 * b + k);
  }
  return code;
}

}  // namespace

TetMesh in_canonical_order(const TetMesh& mesh) {
  std::vector<std::uint64_t> codes;
  for (const Point& p : mesh.nodes) codes.push_back(morton_code(p));
  std::vector<Index> order(mesh.nodes.size()), rank(mesh.nodes.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](Index ia, Index ib) {
    const auto a = static_cast<std::size_t>(ia), b = static_cast<std::size_t>(ib);
    return codes[a] != codes[b] ? codes[a] < codes[b] : mesh.nodes[a] < mesh.nodes[b];
  });
  TetMesh sorted;
  for (std::size_t i = 0; i < order.size(); ++i) {
    rank[static_cast<std::size_t>(order[i])] = static_cast<Index>(i);
    sorted.nodes.push_back(mesh.nodes[static_cast<std::size_t>(order[i])]);
  }
  for (Tet tet : mesh.tets) {
    for (Index& i : tet) i = rank[static_cast<std::size_t>(i)];
    std::ranges::sort(tet);
    const auto node = [&](std::size_t k) { return sorted.nodes[static_cast<std::size_t>(tet[k])]; };
    if (signed_volume6(node(0), node(1), node(2), node(3)) < 0) std::swap(tet[2], tet[3]);
    sorted.tets.push_back(tet);
  }
  std::ranges::sort(sorted.tets);
  return sorted;
}

}  // namespace souple
