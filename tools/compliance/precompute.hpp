// SPDX-License-Identifier: GPL-3.0-or-later
// The rest compliance of a tet mesh: C0 = A0^-1 on its surface nodes.
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "tools/compliance/prepared_body.hpp"

namespace souple {

/// How C0 comes about. automatic: dense where that fits the memory, else by solves.
enum class ComplianceWay { automatic, dense, by_solves };

struct CompliancePrecomputeOptions {
  std::string name = "default";
  ComplianceKind kind = ComplianceKind::dynamic_step;
  double time_step_s = 0.01;  ///< ignored if static
  /// Bound on the measured error, in (0, 0.5]: the hierarchical form. 0: dense tiles of `scalar`.
  double tolerance = 1e-3;
  ErrorNorm norm = ErrorNorm::scaled_spectral;
  ScalarType scalar = ScalarType::float32;
  /// Finest-level nodes that may be touched: the compliance holds those of them on the surface. Empty:
  /// the whole surface. Ascending.
  std::vector<Index> nodes;
  /// 1: C0 of the level below (Galerkin), carried up by the prolongation between the two. The tolerance
  /// bounds what storing it adds; the errors in the header are those against the fine C0.
  int coarsening = 0;
};

/// What all variants of one asset share.
struct CompliancePrecomputeSettings {
  std::size_t memory_limit_bytes = std::size_t{16} << 30;
  ComplianceWay way = ComplianceWay::automatic;
  unsigned threads = 2;                           ///< the result does not depend on it
  std::function<void(double fraction)> progress;  ///< may be empty; called from this thread
  std::function<bool()> cancelled;                ///< may be empty; asked often; true: interrupted
};

/// A0 = a_M M + a_K K with the nodes of `fixed` removed (nullptr: none), inverted on the surface nodes
/// (fixed ones left out): factorised, then the Gram form Y^T Y with
/// Y = L^-1 E_s over the supernodes, or low-rank blocks from solves. `body` keeps
/// what several variants share; `coarser` is the level below (needed for coarsening; may be nullptr).
/// The residual and the error of what is stored are measured and put into the header. Issues:
/// material_out_of_range, fixed_set_invalid, compliance_singular, mesh_element_invalid,
/// compliance_factorisation_failed, compliance_residual_too_large, compliance_out_of_memory,
/// compliance_tolerance_missed, compliance_region_empty, interrupted.
Result<ComplianceVariant> precompute_compliance(PreparedBody& body, const MeshLevel* coarser,
                                                const FixedSet* fixed,
                                                const CompliancePrecomputeOptions& options,
                                                const CompliancePrecomputeSettings& settings);
/// The same for one variant alone.
Result<ComplianceVariant> precompute_compliance(const MeshLevel& level, const MeshLevel* coarser,
                                                const Material& material, const FixedSet* fixed,
                                                const CompliancePrecomputeOptions& options,
                                                const CompliancePrecomputeSettings& settings);

}  // namespace souple
