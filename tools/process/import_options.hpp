// SPDX-License-Identifier: GPL-3.0-or-later
// What the options of all imports have in common.
#pragma once
#include <cstddef>
#include <string>

#include "formats/core/result.hpp"

namespace souple {

/// Issue usage_bad_value: an unknown unit, a target size (m; 0: none) that is negative or not finite, a
/// time limit outside (0, 86400] s, a memory limit below 1 MiB.
Status check_import_options(const std::string& unit, double size_m, double time_limit_s,
                            std::size_t memory_limit_bytes);

/// Metres per unit of the file: so that `longest_side` (of the file's numbers) becomes size_m if that
/// is > 0, else those of the unit. Issue `no_extent`: the result is outside 1e-9 m to 1e15 m.
Result<double> import_scale(double longest_side, const std::string& unit, double size_m,
                            IssueCode no_extent);

}  // namespace souple
