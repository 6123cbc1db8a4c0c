// SPDX-License-Identifier: GPL-3.0-or-later
// The rest compliance of a tet mesh: C0 = A0^-1 on its surface nodes.
#pragma once
#include <cstddef>
#include <functional>
#include <string>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"

namespace souple {

struct CompliancePrecomputeOptions {
  std::string name = "default";
  ComplianceKind kind = ComplianceKind::dynamic_step;
  double time_step_s = 0.01;  ///< ignored if static
  ScalarType scalar = ScalarType::float32;
  std::size_t memory_limit_bytes = std::size_t{16} << 30;
  std::function<void(double fraction)> progress;  ///< may be empty; called from this thread
};

/// Factorises A0 = a_M M + a_K K (CHOLMOD, supernodal) with the nodes of `fixed` removed (nullptr:
/// none) and evaluates the inverse on the surface nodes, fixed ones left out. The residual and the
/// error of the stored scalars are measured and put into the header. Issues: material_out_of_range,
/// fixed_set_invalid, compliance_singular, mesh_element_invalid, compliance_factorisation_failed,
/// compliance_residual_too_large, compliance_out_of_memory.
Result<ComplianceVariant> precompute_compliance(const MeshLevel& level, const Material& material,
                                                const FixedSet* fixed,
                                                const CompliancePrecomputeOptions& options);

}  // namespace souple
