// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// The fixed nodes exist, ascend and leave something to move. Issue fixed_set_invalid.
Status check_fixed_set(const FixedSet& fixed, std::size_t node_count);

/// Every connected part of the mesh has three fixed nodes that are not on one line, so that K has no
/// rigid motion left. Issue compliance_singular, naming a node of the loose part.
Status check_static_support(const TetMesh& mesh, const FixedSet* fixed);

}  // namespace souple
