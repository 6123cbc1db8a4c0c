// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "tools/recipe/recipe.hpp"

namespace souple {

/// The nodes that a request selects, sorted. Issue fixed_set_invalid when it selects none or all; the
/// message names the box of the mesh, because a selection in other units is the usual cause.
Result<FixedSet> select_nodes(const FixedRequest& request, const std::vector<Point>& nodes);

/// The nodes of a region that may be touched, sorted; all of them are fine. Issue
/// compliance_region_empty, at `where`.
Result<std::vector<Index>> select_region(const NodeSelection& selection,
                                         const std::vector<Point>& nodes, const std::string& where);

/// "[0, 0, 0] .. [1, 2, 3] m": the box of the points, for messages about selections that miss.
std::string span_text(const std::vector<Point>& points);

}  // namespace souple
