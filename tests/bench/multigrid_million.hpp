// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

namespace souple::bench {

/// Bakes a liver of a million tets in four nested levels into `file`, in a process of its own, loads it
/// and steps it, held at one side, by the levels of the asset and by lattices; prints rows.
void step_a_million(const std::filesystem::path& file);

}  // namespace souple::bench
