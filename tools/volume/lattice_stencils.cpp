// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/lattice_stencils.hpp"

#include <algorithm>
#include <tuple>
#include <vector>

namespace souple {
namespace {

bool before(const StencilNode& a, const StencilNode& b) {
  return std::tie(a.rank, a.id) < std::tie(b.rank, b.id);
}

}  // namespace

void StencilWriter::write(const std::array<StencilNode, 4>& tet, const CutOf& cut_of) {
  std::vector<std::size_t> in, on, out;
  for (std::size_t k = 0; k < 4; ++k) (tet[k].sign > 0 ? in : tet[k].sign < 0 ? out : on).push_back(k);
  if (in.empty()) return;
  if (out.empty()) return write_tet(tet);
  if (in.size() == 1) {
    std::array<StencilNode, 4> clipped = tet;
    for (const std::size_t k : out) clipped[k] = cut_of(in[0], k);
    return write_tet(clipped);
  }
  if (in.size() == 2 && out.size() == 1)
    return write_pyramid(tet[on[0]],
                         {tet[in[0]], tet[in[1]], cut_of(in[1], out[0]), cut_of(in[0], out[0])});
  if (in.size() == 2)
    return write_prism({tet[in[0]], cut_of(in[0], out[0]), cut_of(in[0], out[1]),  //
                        tet[in[1]], cut_of(in[1], out[0]), cut_of(in[1], out[1])});
  write_prism({tet[in[0]], tet[in[1]], tet[in[2]],  //
               cut_of(in[0], out[0]), cut_of(in[1], out[0]), cut_of(in[2], out[0])});
}

Index StencilWriter::number(const StencilNode& node) {
  const auto [found, is_new] = numbers_.try_emplace(node.id, static_cast<Index>(mesh_.nodes.size()));
  if (is_new) mesh_.nodes.push_back(node.point);
  return found->second;
}

void StencilWriter::write_tet(const std::array<StencilNode, 4>& nodes) {
  Tet tet{number(nodes[0]), number(nodes[1]), number(nodes[2]), number(nodes[3])};
  if (signed_volume6(nodes[0].point, nodes[1].point, nodes[2].point, nodes[3].point) < 0)
    std::swap(tet[2], tet[3]);
  mesh_.tets.push_back(tet);
}

/// `quad` runs around.
void StencilWriter::write_pyramid(const StencilNode& apex, const std::array<StencilNode, 4>& quad) {
  const auto first = static_cast<std::size_t>(std::ranges::min_element(quad, before) - quad.begin());
  const auto at = [&](std::size_t k) { return quad[(first + k) % 4]; };
  write_tet({apex, at(0), at(1), at(2)});
  write_tet({apex, at(0), at(2), at(3)});
}

/// Triangles 0 1 2 and 3 4 5, joined by the edges 0-3, 1-4, 2-5: a cone from the lowest node over the
/// triangle and the quadrilateral that it is not part of.
void StencilWriter::write_prism(const std::array<StencilNode, 6>& prism) {
  const auto lowest = static_cast<std::size_t>(std::ranges::min_element(prism, before) - prism.begin());
  const std::size_t base = lowest < 3 ? 0 : 3, other = 3 - base;
  const std::size_t k = lowest % 3, l = (k + 1) % 3, m = (k + 2) % 3;
  write_tet({prism[lowest], prism[other + k], prism[other + l], prism[other + m]});
  write_pyramid(prism[lowest], {prism[base + l], prism[base + m], prism[other + m], prism[other + l]});
}

}  // namespace souple
