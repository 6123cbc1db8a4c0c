// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of files of unknown origin.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "formats/core/result.hpp"

namespace souple {

/// The bytes of a regular file of at most `limit` bytes; a device or pipe could block or never end.
/// Issues: io_file_missing, io_cannot_read, `too_large`.
Result<std::string> read_regular_file(const std::filesystem::path& file, std::size_t limit,
                                      IssueCode too_large = IssueCode::io_file_too_large);

/// Hex of XXH3, 128 bits.
std::string hash_text(std::string_view bytes);

}  // namespace souple
