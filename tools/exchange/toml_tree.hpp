// SPDX-License-Identifier: GPL-3.0-or-later
// A parsed TOML document without the parser's types: one source file alone includes toml++.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "formats/core/result.hpp"

namespace souple {

struct TomlNode;
struct TomlArray {
  std::vector<TomlNode> items;
};
struct TomlMap {
  std::vector<std::pair<std::string, TomlNode>> items;
};
struct TomlOther {};  ///< dates and times, which nothing here uses

struct TomlNode {
  std::variant<TomlMap, TomlArray, std::string, std::int64_t, double, bool, TomlOther> value;
  int line = 0;
};

/// Issue config_syntax, with line and column.
Result<TomlNode> parse_toml_tree(std::string_view text, const std::string& name);

}  // namespace souple
