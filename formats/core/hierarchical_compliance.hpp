// SPDX-License-Identifier: MIT
// How ComplianceRepresentation::hierarchical lays out a compressed compliance (HODLR: hierarchically
// off-diagonal low rank), shared by the encoder, the file and the runtime. Pure arithmetic.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/core/mesh.hpp"

namespace souple {

/// Positions [begin, end) of the nodes in cluster order.
struct ClusterRange {
  Index begin = 0, end = 0;
  Index size() const { return end - begin; }
};

/// Cluster `i` of the 2^depth that halving n positions `depth` times gives; children of (d, i) are
/// (d + 1, 2 i) and (d + 1, 2 i + 1).
constexpr ClusterRange cluster_range(Index n, int depth, Index i) {
  return {static_cast<Index>((std::int64_t{n} * i) >> depth),
          static_cast<Index>((std::int64_t{n} * (i + 1)) >> depth)};
}

/// Block `b` couples the two children of cluster b in heap order (root 0, children 2 b + 1 and
/// 2 b + 2): depth d holds blocks 2^d - 1 to 2^(d+1) - 2.
constexpr Index block_of_cluster(int depth, Index i) { return (Index{1} << depth) - 1 + i; }

/// All of a compressed compliance but its bulk bytes. With S = blockdiag(L_a) over the nodes,
/// C^ = S (C~ + shift blockdiag(I)) S^T; C~ is symmetric, in cluster order, and made of
/// - one dense block per leaf: leaf_step times integers (lower triangle), and
/// - per block b = (I, J), I the left child: rank[b] terms, C~_IJ = sum_k step^2 a_k b_k^T / singular_k
///   with integer columns a_k (3 |I|) and b_k (3 |J|): every term has the same absolute error.
/// Leaf l's record holds its diagonal integers, then for every block on its path from the root its own
/// rows of a_k or b_k, entropy-coded (runtime/compliance/record_model.hpp). What a contact touches is
/// the records of its leaves.
struct HierarchicalIndex {
  std::int64_t depth = 0;                   ///< 2^depth leaves
  std::vector<Index> order;                 ///< [n] row of the compliance at every position
  std::vector<std::array<float, 6>> scale;  ///< [n] by row: L_a = (00, 10, 11, 20, 21, 22)
  std::vector<float> leaf_step;             ///< [2^depth]
  std::vector<std::uint8_t>
      leaf_planes;                   ///< [2^depth] bytes that hold any integer of its diagonal, 1 to 4
  std::vector<Index> rank;           ///< [2^depth - 1]
  std::vector<float> step;           ///< [2^depth - 1]
  std::vector<float> singular;       ///< [sum of rank] blocks one after another
  std::vector<std::uint8_t> planes;  ///< [sum of rank] bytes that hold any integer of term k
  std::vector<std::int64_t> record_begin;  ///< [2^depth + 1] bytes in the payload
};

/// Empty, or what is wrong with the lengths, counts and numbers: everything that the runtime relies on
/// when it decodes records of a compliance of `node_count` nodes from `payload_bytes` bytes.
std::string fault_of(const HierarchicalIndex& index, std::int64_t node_count,
                     std::uint64_t payload_bytes);

/// Most bytes that the record of leaf `leaf` may have.
std::int64_t record_bytes(const HierarchicalIndex& index, Index node_count, Index leaf);

}  // namespace souple
