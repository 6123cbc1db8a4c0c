// SPDX-License-Identifier: GPL-3.0-or-later
// The scenes of assets/scenes as the benchmarks run them, from the root of the tree.
#pragma once
#include <string>

#include "tests/bench/bench_data.hpp"
#include "tools/scene/scene_world.hpp"

namespace souple::bench {

/// assets/scenes/NAME.toml, each of its assets baked from the recipe of the same name into $BENCH_TMP,
/// or a temporary folder, unless it is there. Ends the program with a message if refused.
Scene bench_scene(const std::string& name);
SceneWorld build_or_exit(const Scene& scene);
/// Moves what the scene grabs, then one step.
StepReport step_or_exit(const Scene& scene, SceneWorld& built);

/// Mean edge length of a soft body's boundary at rest, m.
double mean_edge_m(const SoftBodyAsset& asset);

}  // namespace souple::bench
