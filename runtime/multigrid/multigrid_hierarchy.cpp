// SPDX-License-Identifier: MIT
#include "runtime/multigrid/multigrid_hierarchy.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "runtime/multigrid/lattice_level.hpp"

namespace souple {
namespace {

/// Of the first lattice, over the mean edge of the mesh. Measured: 1.5 needs as many iterations and a
/// third more work, 2.5 a fifth more iterations.
constexpr double spacing_per_edge = 2;

Vec3 lowest_corner(std::span<const Point> points) {
  Vec3 lowest = as_vec3(points.front());
  for (const Point& p : points) lowest = lowest.cwiseMin(as_vec3(p));
  return lowest;
}

Vec3 highest_corner(std::span<const Point> points) {
  Vec3 highest = as_vec3(points.front());
  for (const Point& p : points) highest = highest.cwiseMax(as_vec3(p));
  return highest;
}

/// Between coupled nodes.
double mean_distance(const BlockPattern& pattern, std::span<const Point> positions) {
  double sum = 0;
  for (Index node = 0; node < pattern.node_count(); ++node)
    for (Index k = pattern.diagonal[std::size_t(node)] + 1;
         k < pattern.row_begin[std::size_t(node) + 1]; ++k)
      sum += (as_vec3(positions[std::size_t(node)]) -
              as_vec3(positions[std::size_t(pattern.column[std::size_t(k)])]))
                 .norm();
  return sum / double(std::max<std::size_t>(pattern.block_count() - pattern.diagonal.size(), 2) / 2);
}

/// Not all in one place, and their distances can be computed.
bool span_a_body(std::span<const Point> points) {
  for (const Point& p : points)
    if (!as_vec3(p).allFinite()) return false;
  const double extent = points.empty() ? 0 : (highest_corner(points) - lowest_corner(points)).norm();
  return extent > 0 && std::isfinite(extent);
}

}  // namespace

Index coarsest_node_count(Index node_count) { return Index(8 * std::cbrt(node_count)); }

void MultigridHierarchy::add(const Prolongation& p, GalerkinPlan plan) {
  transitions_.push_back(std::make_unique<Transition>(Transition{PaddedTransfer(p), std::move(plan)}));
}

std::vector<Index> MultigridHierarchy::nodes_at_rest() const {
  const auto nodes = transitions_.back()->plan.lone_nodes();
  return {nodes.begin(), nodes.end()};
}

void MultigridHierarchy::add_lattices(std::vector<Point> positions, std::vector<Index> at_rest,
                                      Index enough) {
  if (Index(positions.size()) <= enough) return;
  const Vec3 lowest = lowest_corner(positions);
  const double extent = (highest_corner(positions) - lowest).maxCoeff();
  // Not too fine to be counted, whatever the tets of a body in many pieces.
  const double spacing =
      std::max(spacing_per_edge * mean_distance(coarsest_pattern(), positions), 1e-6 * extent);
  for (Lattice lattice{as_point(lowest), spacing};
       Index(positions.size()) > enough && lattice.spacing < 4 * extent; lattice.spacing *= 2) {
    LatticeLevel coarse = lattice_level(coarsest_pattern(), positions, at_rest, lattice);
    if (coarse.positions.empty() || 4 * coarse.positions.size() > 3 * positions.size()) continue;
    add(coarse.prolongation, GalerkinPlan::create(coarsest_pattern(), coarse.prolongation));
    at_rest.clear();
    positions = std::move(coarse.positions);
  }
}

Result<MultigridHierarchy> MultigridHierarchy::create(std::span<const MeshLevel> levels,
                                                      const BlockPattern& finest,
                                                      std::span<const Index> fixed) {
  if (levels.empty() || levels.back().mesh.nodes.size() != std::size_t(finest.node_count()))
    return make_issue(
        IssueCode::asset_embedding_invalid,
        "no level has the " + std::to_string(finest.node_count()) + " nodes of the matrix");
  MultigridHierarchy hierarchy;
  hierarchy.finest_ = &finest;
  std::vector<Index> at_rest(fixed.begin(), fixed.end());
  const Index enough = coarsest_node_count(finest.node_count());
  std::size_t level = levels.size() - 1;
  for (; level > 0 && Index(levels[level].mesh.nodes.size()) > enough; --level) {
    const Result<Prolongation> whole = prolongation_of(levels[level], levels[level - 1]);
    if (!whole) return whole.issue();
    const Prolongation p = without_rows(*whole, at_rest);
    hierarchy.add(p, GalerkinPlan::create(hierarchy.coarsest_pattern(), p));
    at_rest = hierarchy.nodes_at_rest();
  }
  hierarchy.add_lattices(levels[level].mesh.nodes, std::move(at_rest), enough);
  return hierarchy;
}

Result<MultigridHierarchy> MultigridHierarchy::open(std::span<const LevelTransition> stored,
                                                    std::span<const Point> coarsest,
                                                    std::span<const Point> positions,
                                                    const BlockPattern& finest,
                                                    std::span<const Index> fixed) {
  MultigridHierarchy hierarchy;
  hierarchy.finest_ = &finest;
  std::vector<Index> at_rest(fixed.begin(), fixed.end());
  const Index enough = coarsest_node_count(finest.node_count());
  std::size_t level = stored.size();
  for (; level > 0 && hierarchy.coarsest_pattern().node_count() > enough; --level) {
    const LevelTransition& transition = stored[level - 1];
    Result<GalerkinPlan> plan = GalerkinPlan::open(hierarchy.coarsest_pattern(), transition, at_rest);
    if (!plan) return plan.issue();
    hierarchy.add(without_rows(prolongation_of(transition), at_rest), std::move(*plan));
    at_rest = hierarchy.nodes_at_rest();
  }
  if (level > 0) return hierarchy;
  const std::span<const Point> lowest_level = stored.empty() ? positions : coarsest;
  const Index expected = hierarchy.coarsest_pattern().node_count();
  if (Index(lowest_level.size()) != expected || !span_a_body(lowest_level))
    return make_issue(IssueCode::asset_multigrid_invalid,
                      std::to_string(lowest_level.size()) + " positions, which do not span a body of " +
                          std::to_string(expected) + " nodes",
                      "multigrid");
  hierarchy.add_lattices({lowest_level.begin(), lowest_level.end()}, std::move(at_rest), enough);
  return hierarchy;
}

std::size_t MultigridHierarchy::bytes() const {
  std::size_t sum = 0;
  for (const auto& transition : transitions_)
    sum += transition->transfer.bytes() + transition->plan.bytes();
  return sum;
}

}  // namespace souple
