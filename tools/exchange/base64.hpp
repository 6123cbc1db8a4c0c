// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <span>
#include <string>

namespace souple {

/// Appends the bytes as base64 (RFC 4648, padded, one line).
void append_base64(std::string& text, std::span<const std::byte> bytes);

}  // namespace souple
