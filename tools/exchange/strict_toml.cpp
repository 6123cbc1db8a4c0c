// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/strict_toml.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/nearest_name.hpp"
#include "tools/exchange/toml_tree.hpp"

namespace souple {
namespace {

constexpr std::size_t file_limit_bytes = std::size_t{1} << 20;
constexpr std::size_t text_limit_bytes = 4096;

std::optional<double> as_number(const TomlNode& node) {
  if (const auto* number = std::get_if<double>(&node.value)) return *number;
  if (const auto* integer = std::get_if<std::int64_t>(&node.value))
    return static_cast<double>(*integer);
  return std::nullopt;
}

bool is_clean_text(std::string_view text) {
  return !text.empty() && text.size() <= text_limit_bytes &&
         std::ranges::none_of(text, [](unsigned char c) { return c < 32 || c == 127; });
}

}  // namespace

struct TomlTable::Document {
  std::string name;
  TomlNode root;
  std::optional<Issue> issue;
  std::optional<Issue> missing;  ///< reported only if nothing else is wrong
  /// Every table that was opened: the keys it was asked for and how messages call it.
  struct Opened {
    std::set<std::string, std::less<>> keys;
    std::string path;
  };
  std::map<const TomlNode*, Opened> opened;
};

TomlTable::TomlTable(std::shared_ptr<Document> document, const TomlNode* node, std::string path)
    : document_(std::move(document)), node_(node), path_(std::move(path)) {
  if (node_ != nullptr) document_->opened[node_].path = path_;
}

Result<TomlTable> TomlTable::parse(std::string_view text, const std::string& name) {
  auto tree = parse_toml_tree(text, name);
  if (!tree) return tree.issue();
  auto document = std::make_shared<Document>();
  document->name = name;
  document->root = std::move(*tree);
  const TomlNode* root = &document->root;
  return TomlTable(std::move(document), root, "");
}

Result<TomlTable> TomlTable::parse_file(const std::filesystem::path& file) {
  const auto text = read_text_file(file, file_limit_bytes);
  if (!text) return text.issue();
  return parse(*text, file.string());
}

const TomlNode* TomlTable::find(std::string_view key) {
  if (node_ == nullptr) return nullptr;
  document_->opened[node_].keys.emplace(key);
  const auto& items = std::get<TomlMap>(node_->value).items;
  const auto found = std::ranges::find(items, key, &std::pair<std::string, TomlNode>::first);
  return found == items.end() ? nullptr : &found->second;
}

bool TomlTable::has(std::string_view key) { return find(key) != nullptr; }

void TomlTable::refuse(IssueCode code, const std::string& what, std::string_view key,
                       std::string mend) {
  if (document_->issue) return;
  document_->issue = make_issue(code, what, where(key), std::move(mend));
}

void TomlTable::refuse_kind(std::string_view key, std::string_view wanted) {
  refuse(IssueCode::config_bad_value, std::string(key) + " has to be " + std::string(wanted), key);
}

std::optional<double> TomlTable::number(std::string_view key, const NumberRange& range) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto value = as_number(*node);
  if (!value) {
    refuse_kind(key, "a number");
    return std::nullopt;
  }
  if (range.contains(*value)) return value;
  refuse(IssueCode::config_bad_value,
         std::string(key) + " = " + rounded_text(*value, 15) + " is outside " + range.text(), key);
  return std::nullopt;
}

std::optional<std::int64_t> TomlTable::integer(std::string_view key, std::int64_t min,
                                               std::int64_t max) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto* value = std::get_if<std::int64_t>(&node->value);
  if (value == nullptr) {
    refuse_kind(key, "a whole number");
    return std::nullopt;
  }
  if (*value >= min && *value <= max) return *value;
  refuse(IssueCode::config_bad_value,
         std::string(key) + " = " + std::to_string(*value) + " is outside [" + std::to_string(min) +
             ", " + std::to_string(max) + "]",
         key);
  return std::nullopt;
}

std::optional<bool> TomlTable::flag(std::string_view key) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (const auto* value = std::get_if<bool>(&node->value)) return *value;
  refuse_kind(key, "true or false");
  return std::nullopt;
}

std::optional<std::string> TomlTable::text(std::string_view key) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto* value = std::get_if<std::string>(&node->value);
  if (value != nullptr && is_clean_text(*value)) return *value;
  refuse_kind(key, "a text of 1 to 4096 bytes without control characters");
  return std::nullopt;
}

std::optional<std::string> TomlTable::choice(std::string_view key,
                                             std::span<const std::string> choices) {
  auto value = text(key);
  if (!value || std::ranges::find(choices, *value) != choices.end()) return value;
  const std::string near = nearest_name(*value, choices);
  refuse(
      IssueCode::config_bad_value, std::string(key) + " = \"" + *value + "\" is not known", key,
      (near.empty() ? "" : "Did you mean \"" + near + "\"? ") + "Known: " + join_names(choices) + ".");
  return std::nullopt;
}

std::optional<std::string> TomlTable::plain_name(std::string_view key) {
  auto value = text(key);
  if (!value || is_plain_name(*value)) return value;
  refuse_kind(key, plain_name_rule);
  return std::nullopt;
}

std::optional<std::vector<double>> TomlTable::numbers(std::string_view key, std::size_t count,
                                                      const NumberRange& range) {
  const TomlNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto* array = std::get_if<TomlArray>(&node->value);
  std::vector<double> values;
  if (array != nullptr && array->items.size() == count)
    for (const TomlNode& item : array->items) {
      const auto value = as_number(item);
      if (!value || !range.contains(*value)) break;
      values.push_back(*value);
    }
  if (values.size() == count) return values;
  refuse_kind(key, "an array of " + std::to_string(count) + " numbers in " + range.text());
  return std::nullopt;
}

std::optional<Point> TomlTable::point(std::string_view key, const NumberRange& range) {
  const auto values = numbers(key, 3, range);
  if (!values) return std::nullopt;
  return Point{(*values)[0], (*values)[1], (*values)[2]};
}

TomlTable TomlTable::table(std::string_view key) {
  const TomlNode* node = find(key);
  const std::string path = (path_.empty() ? "" : path_ + " ") + "[" + std::string(key) + "]";
  if (node != nullptr && !std::holds_alternative<TomlMap>(node->value)) {
    refuse_kind(key, "a table");
    node = nullptr;
  }
  return {document_, node, path};
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  const TomlNode* node = find(key);
  if (node == nullptr) return {};
  const auto* array = std::get_if<TomlArray>(&node->value);
  const auto is_table = [](const TomlNode& item) {
    return std::holds_alternative<TomlMap>(item.value);
  };
  if (array == nullptr || !std::ranges::all_of(array->items, is_table)) {
    refuse_kind(key, "an array of tables, [[" + std::string(key) + "]]");
    return {};
  }
  std::vector<TomlTable> result;
  for (const TomlNode& item : array->items)
    result.push_back(TomlTable(document_, &item,
                               (path_.empty() ? "" : path_ + " ") + "[[" + std::string(key) + "]] " +
                                   std::to_string(result.size() + 1)));
  return result;
}

void TomlTable::require(std::string_view key, std::string_view meaning) {
  if (has(key) || document_->missing) return;
  document_->missing = make_issue(
      IssueCode::config_missing_key,
      "the key \"" + std::string(key) + "\" is missing: " + std::string(meaning), where(key));
}

std::string TomlTable::where(std::string_view key) const {
  std::string text = document_->name;
  int line = node_ == nullptr ? 0 : node_->line;
  if (node_ != nullptr)
    for (const auto& [name, value] : std::get<TomlMap>(node_->value).items)
      if (name == key) line = value.line;
  if (line > 0) text += ":" + std::to_string(line);
  const std::string inside = path_ + (path_.empty() || key.empty() ? "" : " ") + std::string(key);
  return inside.empty() ? text : text + ": " + inside;
}

Status TomlTable::status() const {
  if (document_->issue) return *document_->issue;
  return {};
}

Status TomlTable::finish() {
  if (document_->issue) return *document_->issue;
  // Before missing keys: a misspelt key is why another one is missing.
  const TomlNode* first = nullptr;
  std::string unknown;
  const TomlNode* holder = nullptr;
  for (const auto& [node, table] : document_->opened)
    for (const auto& [key, value] : std::get<TomlMap>(node->value).items) {
      if (table.keys.contains(key) || (first != nullptr && first->line <= value.line)) continue;
      first = &value;
      unknown = key;
      holder = node;
    }
  if (holder != nullptr) {
    const Document::Opened table = document_->opened[holder];
    const std::vector<std::string> known(table.keys.begin(), table.keys.end());
    const std::string near = nearest_name(unknown, known);
    TomlTable(document_, holder, table.path)
        .refuse(IssueCode::config_unknown_key, "the key \"" + unknown + "\" is not known here", unknown,
                (near.empty() ? "" : "Did you mean \"" + near + "\"? ") +
                    "Known keys: " + join_names(known) + ".");
  }
  if (!document_->issue) document_->issue = document_->missing;
  return status();
}

}  // namespace souple
