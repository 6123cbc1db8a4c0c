// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

#include "formats/core/result.hpp"

namespace souple {

enum class SurfaceFormat { obj, off, ply, stl, gltf, fbx, collada, three_ds };

/// "obj", "off", "ply", "stl", "gltf", "fbx", "collada", "3ds".
std::string_view surface_format_name(SurfaceFormat format);

/// What the bytes are; an unmistakable content wins over the extension (".ply", any case). Refuses
/// empty files, UTF-16 and other text with zero bytes, content that is not what the extension says, and
/// formats that are not read.
Result<SurfaceFormat> recognise_surface_format(std::string_view bytes, std::string_view extension);

/// The text without a UTF-8 byte-order mark.
std::string_view without_byte_order_mark(std::string_view text);

}  // namespace souple
