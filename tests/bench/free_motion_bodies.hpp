// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies for the benchmarks of solvers, held at one side, at the reference scale and material.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "runtime/world/soft_body_asset.hpp"

namespace souple::bench {

struct HeldBody {
  std::string name;
  std::vector<MeshLevel> levels;  ///< coarsest first; the last one is that of the asset
  std::shared_ptr<const SoftBodyAsset> asset;
};

inline constexpr const char* held_set = "held";  ///< the tenth with the least x

/// A surface of the data folder filled with about `tets` tets over `level_count` nested levels; longest
/// side 0.2 m, E 1e4 Pa, nu 0.4, rho 1000 kg/m3, alpha 0.1, beta 0.01. Ends the program if refused.
HeldBody held_surface(const std::filesystem::path& surface, std::size_t tets, int level_count);
/// A torus lying in the plane z = 0, of about 1500 tets times 8 for every further level.
HeldBody held_torus(int level_count);

}  // namespace souple::bench
