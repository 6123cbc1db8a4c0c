// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the surfaces of a nested hierarchy's levels, and the target, side by side for a picture.
// Usage: hierarchy_levels FILE TETS LEVELS OUT_FOLDER
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tools/exchange/vtu_writer.hpp"
#include "tools/hierarchy/nested_hierarchy.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/prepare.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple::bench {
namespace {

int fail(const Issue& issue) {
  std::fprintf(stderr, "%s\n", format_issue(issue).c_str());
  return exit_code(issue.code);
}

int write_surface(const std::vector<Point>& points, const std::vector<Triangle>& triangles,
                  const std::filesystem::path& file) {
  VtuMesh mesh;
  mesh.points = points;
  mesh.triangles = triangles;
  const Status written = write_vtu(mesh, file);
  return written.ok() ? 0 : fail(written.issue());
}

int run(const std::filesystem::path& surface, std::size_t tets, int level_count,
        const std::filesystem::path& folder) {
  ImportOptions import;
  import.size_m = 0.2;
  const auto imported = import_surface(surface, import);
  if (!imported) return fail(imported.issue());
  const auto target = orient_closed_surface(imported->mesh);
  if (!target) return fail(target.issue());
  TetrahedralizeOptions options;
  options.target_tet_count = tets;
  const auto coarse = tetrahedralize(target->mesh, options);
  if (!coarse) return fail(coarse.issue());
  NestedHierarchyOptions nested;
  nested.level_count = level_count;
  const auto hierarchy = build_nested_hierarchy(coarse->mesh, target->mesh, nested);
  if (!hierarchy) return fail(hierarchy.issue());
  for (std::size_t l = 0; l < hierarchy->levels.size(); ++l) {
    const MeshLevel& level = hierarchy->levels[l];
    const int code = write_surface(level.mesh.nodes, level.boundary,
                                   folder / ("level_" + std::to_string(l) + ".vtu"));
    if (code != 0) return code;
  }
  return write_surface(target->mesh.vertices, target->mesh.triangles, folder / "target.vtu");
}

}  // namespace
}  // namespace souple::bench

int main(int argument_count, char** arguments) {
  if (argument_count != 5) {
    std::fprintf(stderr, "usage: hierarchy_levels FILE TETS LEVELS OUT_FOLDER\n");
    return 1;
  }
  return souple::bench::run(arguments[1], std::strtoul(arguments[2], nullptr, 10),
                            static_cast<int>(std::strtol(arguments[3], nullptr, 10)), arguments[4]);
}
