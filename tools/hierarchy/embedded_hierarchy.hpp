// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "formats/core/result.hpp"
#include "tools/hierarchy/nested_hierarchy.hpp"

namespace souple {

/// Independent meshes of one body, coarsest first, each finer one embedded in the coarser one by
/// barycentric weights (METHOD 3: "arbitrary"). Issues: mesh_element_invalid, usage_bad_value.
Result<Hierarchy> build_embedded_hierarchy(const std::vector<TetMesh>& meshes,
                                           const TriangleMesh& target);

}  // namespace souple
