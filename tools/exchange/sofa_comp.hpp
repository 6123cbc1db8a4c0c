// SPDX-License-Identifier: GPL-3.0-or-later
// The raw compliance file of SOFA's PrecomputedConstraintCorrection<Vec3d>, by its source
// (Sofa/Component/Constraint/Lagrangian/Correction, PrecomputedConstraintCorrection.inl, v24 to v26):
// - saveCompliance and loadCompliance copy nbRows * nbCols doubles of the machine, row after row, with
//   no header; nbRows = nbCols = 3 times the nodes of the mechanical state, all of them, node-major
//   xyz;
// - buildFileName: NAME-NBROWS-DT.comp, NAME being that of the node of the scene graph and DT its time
//   step as a C++ stream prints it;
// - bwdInit: column 3 f + i is (1/dt) * getPositionIntegrationFactor() times the velocity after one
//   EulerImplicitSolver step from rest under the unit force (f, i). The factor is 1 (the integration
//   factor is dt), and the step solves ((1 + h alpha) M + h (h + beta) K) dv = h f, which is
//   h^2 A0 dv = h f: the column holds A0^-1 e / h, metres per newton-second. SOFA's solver multiplies
//   by impulses, in N s, where souple's C0 = A0^-1 multiplies by forces.
// - nodes held by a projective constraint have rows and columns of zeros.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "formats/core/result.hpp"

namespace souple {

/// The name under which SOFA looks for the file.
std::string sofa_comp_name(std::string_view scene_node, std::int64_t row_count, double time_step_s);

/// Puts rows [first_row, first_row + row_count) of C0, m/N, into `out`: row-major, as long as the
/// matrix.
using ComplianceRows =
    std::function<Status(std::int64_t first_row, std::int64_t row_count, std::span<double> out)>;

/// Writes the file, a few rows at a time; `progress` (may be empty) hears the fraction. `row_count`: 3
/// per node of the mesh. Issues: io_cannot_write (too little room, checked first), those of `rows`.
Status write_sofa_comp(const std::filesystem::path& file, std::int64_t row_count, double time_step_s,
                       const ComplianceRows& rows, const std::function<void(double)>& progress);

}  // namespace souple
