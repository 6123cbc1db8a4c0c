// SPDX-License-Identifier: GPL-3.0-or-later
// What the parsing child answers, as bytes.
#pragma once
#include <string>

#include "tools/surface/polygon_soup.hpp"

namespace souple {

std::string pack_answer(const Result<TriangleSoup>& answer);

/// Trusts nothing: lengths must fit exactly, the checksum must match, indices lie in range, coordinates
/// be finite. What does not is surface_reader_crashed. An issue is handed on with its text made
/// printable.
Result<TriangleSoup> unpack_answer(std::string_view bytes);

}  // namespace souple
