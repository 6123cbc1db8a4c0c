// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

#include "formats/core/result.hpp"
#include "tools/exchange/tet_file.hpp"

namespace souple {

/// By content, and by extension (".msh", any case) where the content has no mark of its own. Issues:
/// tet_file_malformed (empty, or not what the extension says), tet_file_unsupported (another extension,
/// encoding, or binary medit).
Result<TetFormat> recognise_tet_format(std::string_view bytes, std::string_view extension);

std::string_view without_utf8_mark(std::string_view text);

}  // namespace souple
