// SPDX-License-Identifier: GPL-3.0-or-later
// A raw mesh as the bytes that the parsing child answers.
#pragma once
#include <string>
#include <string_view>

#include "tools/exchange/tets/raw_mesh.hpp"

namespace souple {

std::string pack_raw_mesh(const RawMesh& mesh);

/// Trusts nothing: lengths must fit exactly, indices lie in range, coordinates be finite. What does not
/// is surface_reader_crashed.
Result<RawMesh> unpack_raw_mesh(std::string_view bytes);

}  // namespace souple
