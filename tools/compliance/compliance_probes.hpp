// SPDX-License-Identifier: GPL-3.0-or-later
// What a computed compliance is worth, from random probes in double: outside of the way it was
// computed.
#pragma once
#include <functional>

#include "formats/core/asset.hpp"
#include "runtime/compliance/rest_compliance.hpp"
#include "tools/compliance/compliance_system.hpp"
#include "tools/compliance/supernodal_factor.hpp"
#include "tools/compliance/surface_inverse.hpp"
#include "tools/compliance/symmetric_source.hpp"

namespace souple {

/// y = C x for 3n x k matrices.
using ComplianceProduct = std::function<void(const Eigen::MatrixXd& x, Eigen::MatrixXd& y)>;

/// Against solves with the factor. solve_residual: the larger of ||A0 u - f|| / ||f|| and
/// ||C f - u_s|| / ||u_s||, u = A0^-1 f, over the probes f. frobenius is an estimate; worst_column the
/// largest estimate of any column; scaled_spectral an estimate of the Frobenius norm of the difference
/// between D^-1/2, which bounds it, or where that is not small a few steps of Lanczos and a margin.
/// Issue compliance_out_of_memory.
Result<ComplianceError> probe_compliance(const ComplianceSystem& system, const SupernodalFactor& factor,
                                         const SymmetricSource& source,
                                         const ComplianceProduct& product);

/// max ||A0 u - f|| / ||f|| of refined solves for random forces f on the surface, u on all free nodes:
/// computed from the system's matrix, not from what the solves say of themselves.
double probe_solves(const ComplianceSystem& system, const SurfaceInverse& solves);

/// All columns of `stored` against `source`, exactly; scaled_spectral by Lanczos, which comes
/// from below: for errors that are reported, not promised. solve_residual is left as it is.
void measure_stored(const SymmetricSource& source, const RestCompliance& stored,
                    const ComplianceProduct& product, ComplianceError& error);

}  // namespace souple
