// SPDX-License-Identifier: GPL-3.0-or-later
// A stored compliance measured again: against solves with A0 rebuilt from the mesh and the material.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "tools/compliance/supernodal_factor.hpp"

namespace souple {

struct DeepCheckOptions {
  FactorOptions factor;
  int lanczos_steps = 30;
  Index column_nodes = 24;  ///< nodes whose three columns are compared entry by entry
  std::uint32_t seed = 1;   ///< of the probes
  std::function<void(double fraction)> progress;  ///< may be empty
};

/// What was measured, beside what the header claims. Every estimate is at most the true error, so that
/// a truthful header is never refused.
struct DeepCheck {
  double reference_residual = 0;  ///< of the solves that everything is measured against
  double scaled_spectral = 0;     ///< by Lanczos iteration: a lower bound
  double frobenius = 0;           ///< over the compared columns
  double worst_column = 0;        ///< of the compared columns
  double least_curvature = 0;  ///< least x^T C~ x / x^T D x that was met; negative: not semi-definite
  double rounding = 0;         ///< what single precision may add to scaled_spectral
  std::vector<Issue> false_claims;  ///< compliance_claim_false
};

/// `level` is the finest one: a coarse compliance too is measured against the system of that. Issues:
/// those of building and factorising A0, and asset_corrupt if the representation cannot be opened.
Result<DeepCheck> check_deeply(const ComplianceVariant& variant, const MeshLevel& level,
                               const Material& material, const FixedSet* fixed,
                               const DeepCheckOptions& options);

}  // namespace souple
