// SPDX-License-Identifier: GPL-3.0-or-later
// The body that the scene benchmarks share: liver-smooth.obj at the reference scale and material.
#pragma once
#include <memory>

#include "runtime/world/soft_body_asset.hpp"
#include "runtime/world/world.hpp"
#include "tests/bench/bench_data.hpp"
#include "tools/recipe/bake.hpp"

namespace souple::bench {

/// Longest side 0.2 m, E 1e4 Pa, nu 0.4, rho 1000 kg/m3, alpha 0.1, beta 0.01, dynamic h = 0.01 s.
Recipe liver_recipe(std::int64_t tets, std::int64_t levels);

/// Bakes it and reads it back through the asset's bytes. Ends the program with a message if refused.
/// `tolerance` of its compliance; 0: plain single-precision scalars.
std::shared_ptr<const SoftBodyAsset> baked_liver(std::int64_t tets, std::int64_t levels,
                                                 double tolerance = 1e-3);
BakeOutcome bake_or_exit(const Recipe& recipe);

/// The drop scene of assets/scenes/liver_drop.toml: it ends bent over a fixed ball on a fixed floor.
struct DropScene {
  World world;
  BodyId body;
};
DropScene make_drop(std::shared_ptr<const SoftBodyAsset> liver, const WorldSettings& settings);

}  // namespace souple::bench
