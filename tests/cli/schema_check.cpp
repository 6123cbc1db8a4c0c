// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/cli/schema_check.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

namespace souple::test {
namespace {

using nlohmann::json;

bool has_type(const json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  return type == "null" && value.is_null();
}

bool matches_type(const json& value, const json& type) {
  if (type.is_string()) return has_type(value, type);
  return std::ranges::any_of(type, [&](const json& one) { return has_type(value, one); });
}

std::string object_violation(const json& value, const json& schema, const std::string& where) {
  for (const json& key : schema.value("required", json::array()))
    if (!value.contains(key)) return where + " lacks " + key.get<std::string>();
  const json properties = schema.value("properties", json::object());
  for (const auto& [key, member] : value.items()) {
    if (!properties.contains(key)) {
      if (!schema.value("additionalProperties", true)) return where + " has an unknown key " + key;
      continue;
    }
    if (auto violation = schema_violation(member, properties[key], where + "." + key);
        !violation.empty())
      return violation;
  }
  return {};
}

}  // namespace

json load_schema(const std::string& name) {
  std::ifstream in(std::filesystem::path(SOUPLE_SOURCE_DIR) / "tools/commands/schema" /
                   (name + ".json"));
  return json::parse(in, nullptr, false);
}

std::string schema_violation(const json& value, const json& schema, const std::string& where) {
  static const std::array<std::string, 10> words{
      "$schema",    "title",    "description",          "type",  "enum",
      "properties", "required", "additionalProperties", "items", "anyOf"};
  if (!schema.is_object()) return where + ": the schema cannot be read";
  for (const auto& [word, unused] : schema.items())
    if (std::ranges::find(words, word) == words.end()) return where + ": the schema says " + word;
  if (schema.contains("anyOf")) {
    const bool met = std::ranges::any_of(
        schema["anyOf"], [&](const json& one) { return schema_violation(value, one, where).empty(); });
    return met ? "" : where + " meets none of anyOf";
  }
  if (schema.contains("type") && !matches_type(value, schema["type"]))
    return where + " is not of type " + schema["type"].dump();
  if (schema.contains("enum") && std::ranges::find(schema["enum"], value) == schema["enum"].end())
    return where + " is none of " + schema["enum"].dump();
  if (value.is_object()) return object_violation(value, schema, where);
  if (value.is_array() && schema.contains("items"))
    for (std::size_t i = 0; i < value.size(); ++i)
      if (auto violation =
              schema_violation(value[i], schema["items"], where + "[" + std::to_string(i) + "]");
          !violation.empty())
        return violation;
  return {};
}

}  // namespace souple::test
