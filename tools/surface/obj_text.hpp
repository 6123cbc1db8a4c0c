// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

#include "formats/core/result.hpp"

namespace souple {

/// Reduces OBJ text to plain "v x y z" and "f i j k …" lines with positive indices. CGAL's reader stops
/// at lines it does not know (`l`, `call`, …), skips corners separated by tabs, takes index 0 for the
/// next vertex and knows no continued lines; this step does all that, and refuses indices out of range
/// and coordinates that are not finite with their line numbers.
Result<std::string> plain_obj_text(std::string_view text);

}  // namespace souple
