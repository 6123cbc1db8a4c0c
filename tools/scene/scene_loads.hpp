// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/core/result.hpp"
#include "runtime/world/loads.hpp"
#include "tools/scene/scene.hpp"

namespace souple {

class SoftBodyAsset;

/// The load with the nodes or triangles of the asset that its place selects: of a traction or pressure
/// the triangles with all corners selected. Issue load_invalid: nothing is selected.
Result<LoadDescription> place_load(const SceneLoad& load, const SoftBodyAsset& asset,
                                   const std::string& body);

}  // namespace souple
