// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/rigid_surface.hpp"

#include "tools/surface/import_surface.hpp"
#include "tools/surface/prepare.hpp"

namespace souple {

Result<TriangleMesh> read_rigid_surface(const std::filesystem::path& file, double scale,
                                        double size_m) {
  ImportOptions options;
  options.size_m = size_m;
  auto surface = import_surface(file, options);
  if (!surface) return surface.issue();
  auto closed = orient_closed_surface(surface->mesh);
  if (!closed) return closed.issue();
  if (size_m > 0) return std::move(closed->mesh);
  for (Point& vertex : closed->mesh.vertices)
    for (double& coordinate : vertex) coordinate *= scale;
  return std::move(closed->mesh);
}

}  // namespace souple
