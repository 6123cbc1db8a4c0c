// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/ply_text.hpp"

#include <algorithm>
#include <charconv>
#include <vector>

namespace souple {
namespace {

constexpr std::size_t most_properties = 100;

using Words = std::vector<std::string_view>;

/// Splits off the next line that is not empty; false at the end.
bool next_line(std::string_view& text, Words& words) {
  words.clear();
  while (!text.empty() && words.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    for (std::size_t start; (start = line.find_first_not_of(" \t\r")) != line.npos;) {
      line.remove_prefix(start);
      const std::size_t length = std::min(line.size(), line.find_first_of(" \t\r"));
      words.push_back(line.substr(0, length));
      line.remove_prefix(length);
    }
  }
  return !words.empty();
}

std::optional<std::size_t> whole_number(std::string_view word) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

struct Property {
  std::string_view name;
  bool is_list = false;
};

struct Element {
  std::string_view name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

std::optional<std::vector<Element>> read_header(std::string_view& text) {
  std::vector<Element> elements;
  Words words;
  if (!next_line(text, words) || words[0] != "ply") return std::nullopt;
  if (!next_line(text, words) || words.size() < 2 || words[0] != "format" || words[1] != "ascii")
    return std::nullopt;
  while (next_line(text, words) && words[0] != "end_header") {
    if (words[0] == "element" && words.size() >= 3) {
      const auto count = whole_number(words[2]);
      if (!count) return std::nullopt;
      elements.push_back({words[1], *count, {}});
    } else if (words[0] == "property" && words.size() >= 3) {
      if (elements.empty() || elements.back().properties.size() >= most_properties) return std::nullopt;
      elements.back().properties.push_back({words.back(), words[1] == "list"});
    }
  }
  if (words.empty()) return std::nullopt;  // the text ended before the header
  return elements;
}

/// The words of a property of one line; nothing if the line is too short.
std::optional<Words> find_property(const Element& element, const Words& words, std::string_view name) {
  std::size_t at = 0;
  for (const Property& property : element.properties) {
    std::size_t length = 1;
    if (property.is_list) {
      const auto count = at < words.size() ? whole_number(words[at]) : std::nullopt;
      if (!count || *count >= words.size()) return std::nullopt;
      length = *count + 1;
    }
    if (length > words.size() || at > words.size() - length) return std::nullopt;
    if (property.name == name)
      return Words(words.begin() + static_cast<std::ptrdiff_t>(at),
                   words.begin() + static_cast<std::ptrdiff_t>(at + length));
    at += length;
  }
  return std::nullopt;
}

bool append_property(const Element& element, const Words& words, std::string_view name,
                     std::string& plain) {
  const auto found = find_property(element, words, name);
  if (!found) return false;
  for (const std::string_view word : *found) (plain += word) += ' ';
  return true;
}

bool append_line(const Element& element, const Words& words, std::string& plain) {
  if (element.name == "vertex") {
    for (const char* axis : {"x", "y", "z"})
      if (!append_property(element, words, axis, plain)) return false;
  } else if (element.name == "face") {
    if (!append_property(element, words, "vertex_indices", plain) &&
        !append_property(element, words, "vertex_index", plain))
      return false;
  }
  plain += '\n';
  return true;
}

}  // namespace

std::optional<std::string> plain_ply_text(std::string_view text) {
  const auto elements = read_header(text);
  if (!elements) return std::nullopt;
  std::string header = "ply\nformat ascii 1.0\n", body;
  Words words;
  for (const Element& element : *elements) {
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    if (is_vertex || is_face)
      header += "element " + std::string(element.name) + " " + std::to_string(element.count) +
                (is_vertex ? "\nproperty double x\nproperty double y\nproperty double z\n"
                           : "\nproperty list int int vertex_indices\n");
    for (std::size_t i = 0; i < element.count; ++i) {
      if (!next_line(text, words)) return std::nullopt;
      if ((is_vertex || is_face) && !append_line(element, words, body)) return std::nullopt;
    }
  }
  return header + "end_header\n" + body;
}

}  // namespace souple
