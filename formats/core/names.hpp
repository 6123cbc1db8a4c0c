// SPDX-License-Identifier: MIT
// Which texts may stand in an asset.
#pragma once
#include <string_view>

namespace souple {

/// Valid UTF-8 (no overlong forms, surrogates or values past U+10FFFF) without NUL.
bool is_valid_text(std::string_view text);

/// A name of a fixed set, region or variant: valid text of 1 to limits::name_bytes bytes, without '/'
/// and control characters, not "." or "..".
bool is_valid_name(std::string_view name);

}  // namespace souple
