// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace souple {

/// Reduces an ASCII PLY to positions and corners, taking a line for every vertex and face. Real files
/// carry more values a line than their header declares, which a reader that counts words cannot follow.
/// Nothing if the text is no ASCII PLY of this kind or ends early.
std::optional<std::string> plain_ply_text(std::string_view text);

}  // namespace souple
