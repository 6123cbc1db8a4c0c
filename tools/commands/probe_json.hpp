// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "tools/cli/json_output.hpp"
#include "tools/scene/probe_run.hpp"

namespace souple {

/// `probes` of the report of simulate; tools/commands/schema/simulate.json describes it.
Json probes_json(const std::vector<ProbeReport>& probes);
/// One line for people, with its end.
std::string probe_line(const ProbeReport& probe);

}  // namespace souple
