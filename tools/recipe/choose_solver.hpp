// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// What steps of 0.01 s of the body are best begun with: the least counted work, in products with its
/// matrix, to solve a twisted and stretched shape to 1e-4. Work is counted, not timed, so that the same
/// input gives the same asset on every machine. Issues: those of CorotationalModel and SolverParts.
Result<SolverKind> choose_solver(const Asset& asset);

}  // namespace souple
