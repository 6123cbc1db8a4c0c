// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>

#include "formats/core/result.hpp"

namespace souple {

/// Puts `pieces`, one after another, into `file`: written to a new file beside it, flushed to the
/// device, then renamed. On failure what was at `file` is untouched and the new file is gone. Refuses
/// to replace anything but a regular file. Issue: io_cannot_write.
Status replace_file(const std::filesystem::path& file,
                    std::span<const std::span<const std::byte>> pieces);

}  // namespace souple
