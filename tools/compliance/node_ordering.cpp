// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/node_ordering.hpp"

#include <cholmod.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "tools/compliance/lower_pattern.hpp"
#include "tools/compliance/supernode_tree.hpp"

namespace souple {
namespace {

constexpr int most_tries = 6;
/// What a try costs in flops of the dense part, by node; and the share of the whole that tries may
/// take.
constexpr double flops_of_a_try = 5e5, share_of_tries = 0.045;

struct Ordering {
  std::vector<Index> order;
  double flops = 0;
};

/// Owns what an analysis allocates.
struct Analysis {
  cholmod_common common;
  cholmod_factor* factor = nullptr;

  Analysis() {
    cholmod_l_start(&common);
    common.print = 0;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.postorder = 1;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
  }
  Analysis(const Analysis&) = delete;
  Analysis& operator=(const Analysis&) = delete;
  ~Analysis() {
    cholmod_l_free_factor(&factor, &common);
    cholmod_l_finish(&common);
  }
  bool run(LowerPattern& lower) {
    cholmod_sparse view = as_sparse(lower);
    factor = cholmod_l_analyze(&view, &common);
    return factor && factor->is_super;
  }
};

/// The dense work behind an analysis of nodes: the factorisation, and for a surface the forward solves
/// and products.
double flops_of(const cholmod_factor& factor, const std::vector<Index>& order,
                const std::vector<char>& on_surface) {
  const auto longs = [](const void* data, std::size_t count) {
    return std::span(static_cast<const std::int64_t*>(data), count);
  };
  const std::size_t count = factor.nsuper;
  const SupernodeView view{{},
                           longs(factor.super, count + 1),
                           longs(factor.pi, count + 1),
                           longs(factor.s, factor.ssize),
                           {},
                           {}};
  const SupernodeTree tree = build_tree(view);
  std::vector<double> below(order.size() + 1, 0);  // surface nodes before a place
  for (std::size_t k = 0; k < order.size(); ++k)
    below[k + 1] = below[k] + double(on_surface[std::size_t(order[k])]);
  double flops = 0;
  for (std::size_t s = 0; s < count; ++s) {
    const double n = 3 * double(view.columns(s)), m = 3 * double(view.rows(s)) - n;
    const auto first = view.first_column[std::size_t(tree.first_descendant[s])];
    const double w = 3 * (below[std::size_t(view.first_column[s + 1])] - below[std::size_t(first)]);
    flops += n * (n * n / 3 + n * m + m * m) + w * n * (n + 2 * m) + n * w * w;
  }
  return flops;
}

/// Shuffled by `seed`; 0 leaves the order alone. Written out, since the library's shuffle may differ.
std::vector<Index> numbering(std::size_t count, std::uint64_t seed) {
  std::vector<Index> places(count);
  std::iota(places.begin(), places.end(), Index{0});
  if (seed == 0) return places;
  std::uint64_t state = seed * 0x9E3779B97F4A7C15U;
  const auto next = [&state] {  // splitmix64
    std::uint64_t z = state += 0x9E3779B97F4A7C15U;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
  };
  for (std::size_t k = count; k > 1; --k) std::swap(places[k - 1], places[next() % k]);
  return places;
}

Result<Ordering> try_numbering(const BlockPattern& pattern, std::span<const Index> nodes,
                               const std::vector<char>& on_surface, std::uint64_t seed) {
  const std::vector<Index> places = numbering(nodes.size(), seed);
  std::vector<Index> numbered;
  for (const Index place : places) numbered.push_back(nodes[std::size_t(place)]);
  LowerPattern lower = lower_pattern(pattern, numbered, 1);
  Analysis analysis;
  if (!analysis.run(lower))
    return make_issue(IssueCode::compliance_out_of_memory,
                      "the ordering of the system ran out of memory");
  const auto* place = static_cast<const SuiteSparse_long*>(analysis.factor->Perm);
  Ordering ordering;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    ordering.order.push_back(places[std::size_t(place[k])]);
  ordering.flops = flops_of(*analysis.factor, ordering.order, on_surface);
  return ordering;
}

}  // namespace

Result<std::vector<Index>> order_nodes(const BlockPattern& pattern, std::span<const Index> nodes,
                                       std::span<const Index> surface) {
  std::vector<char> is_surface(std::size_t(pattern.node_count()), 0), on_surface;
  for (const Index node : surface) is_surface[std::size_t(node)] = 1;
  for (const Index node : nodes) on_surface.push_back(is_surface[std::size_t(node)]);
  auto best = try_numbering(pattern, nodes, on_surface, 0);
  if (!best) return best.issue();
  const double paying = share_of_tries * best->flops / (flops_of_a_try * double(nodes.size()));
  // One after another: the dissection draws from the process's one generator of random numbers.
  for (int k = 1; k <= int(std::min(paying, double(most_tries))); ++k) {
    auto other = try_numbering(pattern, nodes, on_surface, std::uint64_t(k));
    if (!other) return other.issue();
    if (other->flops < best->flops) best = std::move(other);
  }
  return std::move(best->order);
}

}  // namespace souple
