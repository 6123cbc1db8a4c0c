// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// The surface of a rigid body: any file that a body could be baked from, if it is closed; outward, in
/// metres. `scale`: metres per unit of the file; `size_m` > 0: longest side instead. Issues: those of
/// import_surface and orient_closed_surface.
Result<TriangleMesh> read_rigid_surface(const std::filesystem::path& file, double scale, double size_m);

}  // namespace souple
