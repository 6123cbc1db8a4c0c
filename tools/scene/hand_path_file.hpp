// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "formats/core/result.hpp"
#include "runtime/haptics/devices/recorded_path.hpp"

namespace souple {

/// Where a hand was, as text: a header line that names the columns with their units, then a line for
/// each sample. Columns in any order, parted by commas, semicolons, tabs or blanks:
///   time_s | time_ms | time_us, x_m y_m z_m | x_cm ... | x_mm ..., qw qx qy qz (all or none),
///   opening_rad | opening_deg (or none)
/// Lines that are empty or begin with # are passed over. Issues: hand_path_*.
Result<RecordedPath> parse_hand_path(std::string_view text, const std::string& name);
/// At most 256 MiB. Issues: those of read_text_file, with hand_path_too_large, and hand_path_*.
Result<RecordedPath> read_hand_path(const std::filesystem::path& file);

}  // namespace souple
