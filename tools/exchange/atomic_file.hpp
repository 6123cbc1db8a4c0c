// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "formats/core/result.hpp"

namespace souple {

/// Writes `text` to a temporary file beside `file`, flushes it to the device and renames: readers see
/// the old file or the whole new one. On failure nothing is left behind. Issue io_cannot_write.
Status write_file_atomically(const std::filesystem::path& file, std::string_view text);

/// Appends bytes to the file being written. Issue io_cannot_write.
using AppendBytes = std::function<Status(std::string_view bytes)>;

/// The same for a file that is too large to stand in memory: `produce` hands over its pieces. Whatever
/// stops it, nothing is left behind. Issues: io_cannot_write, and those of `produce`.
Status write_pieces_atomically(const std::filesystem::path& file,
                               const std::function<Status(const AppendBytes& append)>& produce);

/// The bytes of a regular file of at most `limit` bytes.
/// Issues: io_file_missing, io_cannot_read, io_file_too_large.
Result<std::string> read_text_file(const std::filesystem::path& file, std::size_t limit);

/// Creates the folder (and its parents) unless it is there, and checks that files can be made in it.
/// Issue io_cannot_write.
Status make_output_folder(const std::filesystem::path& folder);

/// Refuses early, before long work, a file that could not be written: a directory in its place, or a
/// folder that is missing or read-only. Issue io_cannot_write.
Status check_output_file(const std::filesystem::path& file);

}  // namespace souple
