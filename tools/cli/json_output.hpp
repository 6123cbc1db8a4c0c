// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string_view>

#include "formats/core/result.hpp"

namespace souple {

/// Keys stay in the order in which they were put in.
using Json = nlohmann::ordered_json;

/// {"schema": "souple.<name>", "schema_version": 1}: documented in tools/commands/schema/<name>.json.
Json schema_header(std::string_view name);

Json issue_json(const Issue& issue);
/// The whole document for a verb that was stopped.
Json stopped_json(const Issue& issue);

/// As text of two-space indents; bytes that are not UTF-8 are replaced, NaN becomes null.
std::string json_text(const Json& document);

/// Puts text on stdout and flushes. Issue io_cannot_write (a full disk, a closed pipe).
Status print_data(std::string_view text);
Status print_json(const Json& document);

}  // namespace souple
