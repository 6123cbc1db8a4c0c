// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "tools/cli/json_output.hpp"
#include "tools/scene/simulation.hpp"

namespace souple {

/// The content of report.json; tools/commands/schema/simulate.json describes it.
Json simulation_json(const Scene& scene, const SceneWorld& built, const SimulationReport& report,
                     const std::string& scene_file);

}  // namespace souple
