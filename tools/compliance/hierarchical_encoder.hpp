// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "tools/compliance/hodlr_matrix.hpp"
#include "tools/compliance/symmetric_source.hpp"

namespace souple {

struct EncodeOptions {
  double tolerance = 1e-3;  ///< bound on the measured error, shift included; in (0, 0.5]
  ErrorNorm norm = ErrorNorm::scaled_spectral;
  Index leaf_nodes = 32;  ///< about so many nodes per leaf at most
  unsigned threads = 2;   ///< the result does not depend on it
  /// For factors of C~ in double, which show by how little a shift it stays positive definite. Where
  /// they do not fit, products with C show a shift that is enough.
  std::size_t factor_limit_bytes = 1'600'000'000;
  std::function<void(double fraction)> progress;  ///< may be empty
  /// May be empty; asked on the calling thread between blocks and rounds. True: issue interrupted.
  std::function<bool()> cancelled;
};

struct EncodedCompliance {
  HierarchicalIndex index;
  std::vector<std::byte> payload;
  ComplianceError
      error;  ///< measured on what will be decoded, shift included; solve_residual untouched
  double shift = 0;
};

/// The cluster order: nodes bisected again and again along the axis in which they spread most, so that
/// a turned body has the same clusters; ties by index. [n] row at every position.
std::vector<Index> cluster_order(std::span<const Point> positions);
/// Halvings until leaves have at most about `leaf_nodes` nodes.
int cluster_depth(Index node_count, Index leaf_nodes);

/// Low-rank blocks of a dense source by randomised SVD, truncated well below the tolerance, scaled for
/// the norm. `positions`: rest positions of the rows, m. Issues: compliance_factorisation_failed,
/// interrupted.
Result<HodlrMatrix> compress_dense(const SymmetricSource& source, std::span<const Point> positions,
                                   const EncodeOptions& options);

/// Quantises until the measured error is within (tolerance / 3, tolerance]. `source`: what the error is
/// measured against, exactly (all columns). Issues: compliance_tolerance_missed, interrupted.
Result<EncodedCompliance> encode_hierarchical(const HodlrMatrix& matrix, const SymmetricSource& source,
                                              const EncodeOptions& options);
/// The same with an operator: spectral error by Lanczos, Frobenius and columns by random probes.
Result<EncodedCompliance> encode_hierarchical(const HodlrMatrix& matrix, const SymmetricOperator& exact,
                                              const EncodeOptions& options);

}  // namespace souple
