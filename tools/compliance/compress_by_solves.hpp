// SPDX-License-Identifier: GPL-3.0-or-later
// The hierarchical form of a compliance that is never formed: randomised peeling (Lin, Lu, Ying 2011;
// Martinsson 2016) with many solves at once on a supernodal factor.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "runtime/fem/block_matrix.hpp"
#include "tools/compliance/hodlr_matrix.hpp"
#include "tools/compliance/symmetric_source.hpp"

namespace souple {

struct SolveCompressionOptions {
  /// Bound on the error of what will be stored; the sampled form keeps to about a third of it, the rest
  /// is for quantisation. In (0, 0.5].
  double tolerance = 1e-3;
  ErrorNorm norm = ErrorNorm::scaled_spectral;
  Index leaf_nodes = 64;  ///< about so many nodes per leaf
  unsigned threads = 2;   ///< the bits do not depend on it
  std::size_t memory_limit_bytes = std::size_t{8} << 30;
  std::function<void(double fraction)> progress;  ///< may be empty; called from the calling thread
  std::function<bool()> cancelled;                ///< may be empty; asked often, from any thread
};

struct SolveCompressionReport {
  std::int64_t right_sides = 0;   ///< solved for
  std::size_t factor_bytes = 0;   ///< of the factor that the solves use (single precision)
  std::size_t planned_bytes = 0;  ///< largest amount of memory the work was expected to hold at once
  double noise = 0;               ///< rounding errors of a product with signs, root mean square, of C~
  bool refined = false;           ///< single precision was not enough: solves were refined in double
  std::vector<Index> level_rank;  ///< [depth] largest rank of every level
};

struct CompressedBySolves {
  HodlrMatrix matrix;
  /// y = C x by refined solves in double: what the certificate is measured against. Independent of
  /// `a0`, owns the factor. Rows in the order of `surface_nodes`.
  std::unique_ptr<const SymmetricOperator> exact;
  SolveCompressionReport report;
};

/// C = (A0^-1) on `surface_nodes`, A0 being the part of `a0` on `free_nodes` (both ascending, the
/// surface among the free). `positions`: rest positions of the surface nodes, m. Issues:
/// compliance_out_of_memory (before anything of that size is allocated),
/// compliance_factorisation_failed, compliance_tolerance_missed (below what solves in double resolve),
/// compliance_region_empty, interrupted.
Result<CompressedBySolves> compress_by_solves(const BlockMatrix& a0, std::span<const Index> free_nodes,
                                              std::span<const Index> surface_nodes,
                                              std::span<const Point> positions,
                                              const SolveCompressionOptions& options);

}  // namespace souple
