// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/toml_tree.hpp"

#define TOML_EXCEPTIONS 0
#include <toml++/toml.h>

namespace souple {
namespace {

TomlNode convert(const toml::node& node);

TomlMap convert_table(const toml::table& table) {
  TomlMap map;
  map.items.reserve(table.size());
  for (const auto& [key, value] : table) map.items.emplace_back(std::string(key.str()), convert(value));
  return map;
}

TomlArray convert_array(const toml::array& array) {
  TomlArray list;
  list.items.reserve(array.size());
  for (const toml::node& item : array) list.items.push_back(convert(item));
  return list;
}

// Depth is bounded by the parser's own limit on nesting (256).
TomlNode convert(const toml::node& node) {
  TomlNode result;
  result.line = static_cast<int>(node.source().begin.line);
  if (const auto* table = node.as_table())
    result.value = convert_table(*table);
  else if (const auto* array = node.as_array())
    result.value = convert_array(*array);
  else if (const auto* text = node.as_string())
    result.value = text->get();
  else if (const auto* integer = node.as_integer())
    result.value = integer->get();
  else if (const auto* number = node.as_floating_point())
    result.value = number->get();
  else if (const auto* flag = node.as_boolean())
    result.value = flag->get();
  else
    result.value = TomlOther{};
  return result;
}

}  // namespace

Result<TomlNode> parse_toml_tree(std::string_view text, const std::string& name) {
  const toml::parse_result parsed = toml::parse(text, name);
  if (!parsed) {
    const auto& at = parsed.error().source().begin;
    return make_issue(IssueCode::config_syntax, std::string(parsed.error().description()),
                      name + ":" + std::to_string(at.line) + ":" + std::to_string(at.column));
  }
  return convert(parsed.table());
}

}  // namespace souple
