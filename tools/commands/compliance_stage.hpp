// SPDX-License-Identifier: GPL-3.0-or-later
// The stage of the compliances as a verb runs it: signals stop it in an orderly way.
#pragma once
#include <functional>
#include <string>

#include "formats/core/result.hpp"
#include "tools/cli/console.hpp"
#include "tools/recipe/bake.hpp"

namespace souple {

/// add_compliances; after SIGINT or SIGTERM the issue `interrupted` is told as any other, `kept` says
/// what is left for the next run (empty: nothing), and the process ends by that signal, as its caller
/// expects.
Status run_compliance_stage(BakeOutcome& outcome, const Recipe& recipe, ComplianceStage stage,
                            ProgressSink& progress, Console& console, bool json,
                            const std::function<std::string()>& kept = {});

/// write_baked_asset with signals held: an interrupt waits until the temporary file was renamed or
/// removed.
Status write_held(BakeOutcome& outcome, const std::string& file, ProgressSink& progress);

}  // namespace souple
