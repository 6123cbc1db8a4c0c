// SPDX-License-Identifier: MIT
// Writes an asset of one cube of six tetrahedra, without compliance. Usage: souple_small_asset ASSET
#include <cstdio>

#include "formats/core/asset.hpp"
#include "formats/write/asset_writer.hpp"

namespace {

// Kuhn's division of the unit cube: six tets around the diagonal from node 0 to node 7, where node i
// has the coordinates (bit 0, bit 1, bit 2) of i.
souple::Asset cube_asset() {
  souple::MeshLevel level;
  for (int i = 0; i < 8; ++i) {
    level.mesh.nodes.push_back({0.1 * (i & 1), 0.1 * (i >> 1 & 1), 0.1 * (i >> 2 & 1)});
  }
  level.mesh.tets = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                     {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  level.boundary = souple::boundary_triangles(level.mesh.tets);

  souple::Asset asset;
  asset.levels.push_back(level);
  asset.material.regions.push_back({"all", 1e4, 0.4, 1000.0});
  asset.provenance.generator = "souple_small_asset";
  asset.provenance.input_name = "cube";
  asset.provenance.input_hash = "00000000000000000000000000000000";
  return asset;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 2) {
    std::fprintf(stderr, "usage: souple_small_asset ASSET\n");
    return 1;
  }
  const souple::Status written = souple::write_asset(cube_asset(), arguments[1]);
  if (written.ok()) return 0;
  std::fprintf(stderr, "%s\n", souple::format_issue(written.issue()).c_str());
  return souple::exit_code(written.issue().code);
}
