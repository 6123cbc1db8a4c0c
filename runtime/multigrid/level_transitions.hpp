// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// What an asset stores between its levels (coarsest first), [l - 1] from level l to level l - 1: P and
/// the plan of its product, for the body without fixed nodes. Empty for one level. Issues:
/// asset_embedding_invalid, asset_index_out_of_range.
Result<std::vector<LevelTransition>> store_transitions(std::span<const MeshLevel> levels);

}  // namespace souple
