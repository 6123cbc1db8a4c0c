// SPDX-License-Identifier: GPL-3.0-or-later
// TOML that refuses what it does not know: every key has to be asked for, every value to be of its
// kind, finite and in range. The first thing wrong is kept, with its line.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"
#include "tools/exchange/numbers.hpp"

namespace souple {

struct TomlNode;  // a parsed value; its definition stays with the parser

/// One table of a document while it is read. Asking for a key makes it known; `finish` refuses the
/// rest, here and in every table that was opened from this one. A getter returns nothing when the key
/// is absent or its value was refused; ask `status()` of any table of the document at the end.
class TomlTable {
 public:
  /// `name` stands in messages. Issues: config_syntax.
  static Result<TomlTable> parse(std::string_view text, const std::string& name);
  /// At most 1 MiB. Issues: those of read_text_file and parse.
  static Result<TomlTable> parse_file(const std::filesystem::path& file);

  bool has(std::string_view key);
  std::optional<double> number(std::string_view key, const NumberRange& range);
  std::optional<std::int64_t> integer(std::string_view key, std::int64_t min, std::int64_t max);
  std::optional<bool> flag(std::string_view key);
  /// Not empty, at most 4096 bytes, without control characters.
  std::optional<std::string> text(std::string_view key);
  std::optional<std::string> choice(std::string_view key, std::span<const std::string> choices);
  /// As text, and a plain name (nearest_name.hpp).
  std::optional<std::string> plain_name(std::string_view key);
  /// An array of exactly `count` numbers.
  std::optional<std::vector<double>> numbers(std::string_view key, std::size_t count,
                                             const NumberRange& range);
  std::optional<Point> point(std::string_view key, const NumberRange& range);
  /// Empty, and harmless to read, when the key is absent.
  TomlTable table(std::string_view key);
  std::vector<TomlTable> tables(std::string_view key);  ///< [[key]]

  /// Refuses with a reason of the caller's; the first refusal of a document wins.
  void refuse(IssueCode code, const std::string& what, std::string_view key, std::string mend = {});
  void require(std::string_view key, std::string_view meaning);  ///< config_missing_key
  std::string where(std::string_view key) const;                 ///< "recipe.toml:7: [mesh] tets"

  /// Refuses unknown keys of all tables of the document (config_unknown_key), then tells the outcome.
  Status finish();
  Status status() const;

 private:
  struct Document;
  TomlTable(std::shared_ptr<Document> document, const TomlNode* node, std::string path);
  const TomlNode* find(std::string_view key);
  void refuse_kind(std::string_view key, std::string_view wanted);

  std::shared_ptr<Document> document_;
  const TomlNode* node_;  ///< nullptr: the table is absent
  std::string path_;      ///< "[mesh]", "[[fixed]] 2", empty for the root
};

}  // namespace souple
