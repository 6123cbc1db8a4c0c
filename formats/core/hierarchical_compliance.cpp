// SPDX-License-Identifier: MIT
#include "formats/core/hierarchical_compliance.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace souple {
namespace {

// More halvings than any compliance has use for: 2^20 leaves.
constexpr std::int64_t largest_depth = 20;
// C~ is dimensionless with entries about 1 and the roots of compliances lie far inside these bounds, so
// that no product of the decoder overflows single precision.
constexpr float largest_factor = 1e6F, largest_scale = 1e12F;
// A leaf is a dense block, which its record may hold in few bytes; so may a record its factors, as an
// integer takes 0.0034 bits or more. Both bound what decoding allocates.
constexpr Index largest_leaf_nodes = 256;
constexpr std::int64_t largest_integers_per_byte = 4096, largest_integer_count = std::int64_t{1} << 32;

bool is_permutation_of_rows(const std::vector<Index>& order) {
  std::vector<bool> seen(order.size(), false);
  for (const Index row : order) {
    if (row < 0 || std::size_t(row) >= order.size() || seen[std::size_t(row)]) return false;
    seen[std::size_t(row)] = true;
  }
  return true;
}

bool is_sound_scale(const std::array<float, 6>& l) {
  const bool bounded = std::ranges::all_of(
      l, [](float entry) { return std::isfinite(entry) && std::abs(entry) <= largest_scale; });
  return bounded && l[0] > 0 && l[2] > 0 && l[5] > 0;
}

// Largest magnitude of an integer of `planes` bytes, two's complement.
float largest_integer(std::uint8_t planes) { return std::ldexp(1.0F, 8 * planes - 1); }

bool is_sound_term(float step, float singular, std::uint8_t planes) {
  return planes >= 1 && planes <= 4 && std::isfinite(step) && step > 0 && std::isfinite(singular) &&
         singular > 0 && step * largest_integer(planes) <= largest_factor * std::sqrt(singular);
}

std::string fault_of_sizes(const HierarchicalIndex& index, std::int64_t node_count) {
  if (index.depth < 0 || index.depth > largest_depth || (std::int64_t{1} << index.depth) > node_count)
    return "a depth of " + std::to_string(index.depth) + " does not fit " + std::to_string(node_count) +
           " nodes";
  if ((node_count >> index.depth) >= largest_leaf_nodes) return "the leaves have too many nodes";
  const std::size_t leaves = std::size_t{1} << index.depth;
  if (index.order.size() != std::size_t(node_count) || index.scale.size() != std::size_t(node_count))
    return "order and scale do not have one entry per node";
  if (index.leaf_step.size() != leaves || index.leaf_planes.size() != leaves ||
      index.record_begin.size() != leaves + 1)
    return "the numbers of the leaves do not have one entry per leaf";
  if (index.rank.size() != leaves - 1 || index.step.size() != leaves - 1)
    return "rank and step do not have one entry per block";
  return {};
}

std::string fault_of_leaves(const HierarchicalIndex& index) {
  for (std::size_t l = 0; l < index.leaf_step.size(); ++l) {
    const float step = index.leaf_step[l];
    const std::uint8_t planes = index.leaf_planes[l];
    if (planes < 1 || planes > 4 || !(std::isfinite(step) && step > 0) ||
        step * largest_integer(planes) > largest_factor)
      return "leaf " + std::to_string(l) + " cannot be decoded";
  }
  return {};
}

std::string fault_of_blocks(const HierarchicalIndex& index, Index node_count) {
  std::size_t term = 0;
  for (int depth = 0; depth < index.depth; ++depth)
    for (Index i = 0; i < (Index{1} << depth); ++i) {
      const Index b = block_of_cluster(depth, i);
      const Index smaller = std::min(cluster_range(node_count, depth + 1, 2 * i).size(),
                                     cluster_range(node_count, depth + 1, 2 * i + 1).size());
      const Index rank = index.rank[std::size_t(b)];
      const std::string name = "block " + std::to_string(b);
      if (rank < 0 || rank > 3 * smaller) return name + " has an impossible rank";
      if (std::min(index.singular.size(), index.planes.size()) - term < std::size_t(rank))
        return name + " has fewer terms than its rank";
      for (const std::size_t end = term + std::size_t(rank); term < end; ++term)
        if (!is_sound_term(index.step[std::size_t(b)], index.singular[term], index.planes[term]))
          return name + " cannot be decoded";
    }
  if (index.singular.size() != term || index.planes.size() != term)
    return "there are more terms than the ranks add up to";
  return {};
}

// First term of every block, and their number.
std::vector<std::size_t> first_terms(const HierarchicalIndex& index) {
  std::vector<std::size_t> first{0};
  for (const Index rank : index.rank) first.push_back(first.back() + std::size_t(rank));
  return first;
}

struct RecordSize {
  std::int64_t integers = 0;
  std::int64_t bytes = 0;  ///< at most
};

RecordSize record_size(const HierarchicalIndex& index, std::span<const std::size_t> first,
                       Index node_count, Index leaf) {
  const auto depth = int(index.depth);
  const std::int64_t rows = 3 * std::int64_t{cluster_range(node_count, depth, leaf).size()};
  RecordSize size;
  size.integers = rows * (rows + 1) / 2;
  size.bytes = size.integers * index.leaf_planes[std::size_t(leaf)];
  for (int d = 0; d < depth; ++d) {
    const auto b = std::size_t(block_of_cluster(d, leaf >> (depth - d)));
    size.integers += rows * index.rank[b];
    for (std::size_t k = first[b]; k < first[b + 1]; ++k) size.bytes += rows * index.planes[k];
  }
  // What coding may add to integers that it cannot make smaller.
  size.bytes += size.bytes / 8 + 64;
  return size;
}

std::string fault_of_records(const HierarchicalIndex& index, Index node_count,
                             std::uint64_t payload_bytes) {
  const auto& begin = index.record_begin;
  const auto first = first_terms(index);
  if (begin.front() != 0) return "the first record does not begin the payload";
  std::int64_t integers = 0;
  for (std::size_t l = 0; l < index.leaf_step.size(); ++l) {
    const RecordSize size = record_size(index, first, node_count, Index(l));
    integers += size.integers;
    // Ascending from 0, so that the difference cannot overflow.
    const std::int64_t bytes = begin[l + 1] < begin[l] ? -1 : begin[l + 1] - begin[l];
    if (bytes < 0 || bytes > size.bytes || size.integers / largest_integers_per_byte > bytes ||
        integers > largest_integer_count)
      return "record " + std::to_string(l) + " has an impossible size";
  }
  if (std::uint64_t(begin.back()) != payload_bytes)
    return "the records need " + std::to_string(begin.back()) + " bytes, there are " +
           std::to_string(payload_bytes);
  return {};
}

}  // namespace

std::string fault_of(const HierarchicalIndex& index, std::int64_t node_count,
                     std::uint64_t payload_bytes) {
  if (node_count < 1 || node_count > (Index{1} << 28)) return "the node count is out of range";
  if (auto fault = fault_of_sizes(index, node_count); !fault.empty()) return fault;
  if (!is_permutation_of_rows(index.order)) return "the order is not a permutation of the rows";
  if (!std::ranges::all_of(index.scale, is_sound_scale)) return "a scale is not a bounded triangle";
  if (auto fault = fault_of_leaves(index); !fault.empty()) return fault;
  if (auto fault = fault_of_blocks(index, Index(node_count)); !fault.empty()) return fault;
  return fault_of_records(index, Index(node_count), payload_bytes);
}

std::int64_t record_bytes(const HierarchicalIndex& index, Index node_count, Index leaf) {
  return record_size(index, first_terms(index), node_count, leaf).bytes;
}

}  // namespace souple
