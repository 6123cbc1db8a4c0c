// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace souple {

/// The candidate nearest to a misspelt name (edit distance with swaps of neighbours), or an empty
/// string when none is near enough to be a likely slip of the fingers.
std::string nearest_name(std::string_view name, std::span<const std::string> candidates);

/// "a, b, c".
std::string join_names(std::span<const std::string> names);

/// Names of bodies, fixed sets and compliances: 1 to 64 of A-Z a-z 0-9 _ - . and no leading dot, so
/// that they can stand in file names and in the paths inside an asset.
bool is_plain_name(std::string_view name);
inline constexpr std::string_view plain_name_rule =
    "1 to 64 characters of A-Z a-z 0-9 _ - . and no dot in front";

}  // namespace souple
