// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace souple::test {

/// tools/commands/schema/<name>.json.
nlohmann::json load_schema(const std::string& name);

/// Empty if the value meets the schema, else where and why not. Knows the words that the schemas use
/// (type, enum, properties, required, additionalProperties, items, anyOf) and refuses any other.
std::string schema_violation(const nlohmann::json& value, const nlohmann::json& schema,
                             const std::string& where = "$");

}  // namespace souple::test
