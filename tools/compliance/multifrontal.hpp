// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <span>

#include "formats/core/result.hpp"
#include "runtime/fem/block_matrix.hpp"
#include "tools/compliance/supernodal_factor.hpp"

namespace souple {

/// The matrix to be factorised, by elimination order.
struct PermutedMatrix {
  const BlockMatrix* a = nullptr;
  std::span<const Index> nodes;            ///< of `a`, ascending: the unknowns
  std::span<const Index> order;            ///< [nodes] local node at every place in the order
  std::span<const std::int64_t> position;  ///< [nodes of a] first scalar in the order; -1: left out
};

/// Most bytes that the factorisation holds at once beside the factor.
double multifrontal_bytes(const SupernodeView& view, unsigned threads);

/// Fills `values` with the factor whose structure `view` describes (its values are not looked at):
/// fronts are assembled from the matrix and the children's updates, eliminated by blocks, and handed up
/// (Duff, Reid 1983; Liu 1992). Issues: compliance_factorisation_failed, interrupted.
Status factorise(const PermutedMatrix& matrix, const SupernodeView& view, std::span<double> values,
                 const FactorOptions& options);

}  // namespace souple
