// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "formats/core/asset.hpp"

namespace souple {

/// XXH3, 128 bits, 32 hex digits, over the logical content: levels, visual surface, material,
/// fixed sets and compliances. Independent of compression, layout and the order of named parts; the
/// provenance is not part of it.
std::string content_hash(const Asset& asset);

}  // namespace souple
