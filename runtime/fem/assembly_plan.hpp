// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/fem/block_matrix.hpp"
#include "runtime/fem/element_lanes.hpp"

namespace souple {

/// Where the parts of a stiffness matrix go: made once, replayed at every step without searching.
///
/// With g_i = sqrt(V mu) R grad N_i, tet e adds r g_i g_j^T + g_j g_i^T + (g_i . g_j) I to block (i,
/// j), r = lambda / mu. The last term does not turn: its sum is stored. Of the others one sum of outer
/// products P_ij is enough: P_ij^T is its transposed, and P_ji too. Blocks below the diagonal are the
/// transposed of those above; those on it are minus the sum of their row, because rigid translations
/// take no force.
///
/// Work is split by bands of consecutive rows. Every block is written by one band, so that bands of the
/// same phase are independent; sums have a fixed order.
class AssemblyPlan {
 public:
  AssemblyPlan() = default;
  /// `rest_gradients`: of ElementLanes::gradients without rotations. `ratio`: lambda / mu of
  /// every tet. Fewer than 2^29 tets.
  AssemblyPlan(const BlockPattern& pattern, std::span<const Tet> tets,
               std::span<const CornerVector> rest_gradients, std::vector<double> ratio);

  IndexRange all_bands() const { return {0, static_cast<Index>(band_begin_.size()) - 1}; }
  /// First phase: what is not on the diagonal, of factor times the stiffness.
  void assemble_off_diagonal(std::span<const CornerVector> gradients, double factor, IndexRange bands,
                             BlockMatrix& out) const;
  /// Second phase, when the first is complete: the diagonal, with mass_factor times the masses.
  void assemble_diagonal(double mass_factor, std::span<const double> masses, IndexRange bands,
                         BlockMatrix& out) const;
  /// Identity rows and columns for the nodes that are held.
  void hold(std::span<const char> is_held, BlockMatrix& out) const;

  std::size_t bytes() const;

 private:
  struct OffDiagonal {
    Index upper = 0, lower = 0;  ///< positions of the block and of its mirror image
    Index term_end = 0;          ///< its terms begin where those of the block before end
    double dot_sum = 0;          ///< sum of g_i . g_j
  };
  /// The corners i and j of a tet: 4 tet + i and 4 tet + j.
  struct Term {
    std::uint32_t first, second;
  };
  /// Blocks above the diagonal, by band and number of terms; mirror images.
  void order_blocks(const BlockPattern& pattern, std::span<const Index> term_count);
  void fill_terms(std::span<const Tet> tets, std::span<const CornerVector> rest_gradients,
                  std::span<const Index> term_count, std::span<const Index> places);
  template <bool is_uniform>
  void assemble_bands(std::span<const CornerVector> gradients, double factor, IndexRange bands,
                      BlockMatrix& out) const;

  std::vector<OffDiagonal> blocks_;  ///< by band, then by number of terms: a loop that can be foretold
  std::vector<Index> band_begin_;    ///< first block of every band
  std::vector<Term> terms_;          ///< tets ascending within a block
  std::vector<double> ratio_;        ///< lambda / mu by tet; a single one if they are all the same
  std::vector<Index> mirror_;        ///< position of the mirror image of every block
};

}  // namespace souple
