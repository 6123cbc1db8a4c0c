// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "tools/commands/asset_json.hpp"
#include "tools/recipe/bake.hpp"

namespace souple {

/// The report of a bake; tools/commands/schema/bake.json describes it.
Json bake_json(const BakeOutcome& outcome, const std::string& asset_file);

}  // namespace souple
