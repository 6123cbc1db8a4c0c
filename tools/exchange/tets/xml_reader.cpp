// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/xml_reader.hpp"

#include <algorithm>
#include <array>

#include "tools/exchange/tets/raw_mesh.hpp"
#include "tools/exchange/tets/text_cursor.hpp"

namespace souple {
namespace {

constexpr std::size_t deepest = 64, most_attributes = 64;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '.' || c == ':';
}

}  // namespace

void XmlReader::fail(const std::string& what) {
  if (issue_) return;
  const auto line = 1 + std::ranges::count(text_.substr(0, at_), '\n');
  issue_ = malformed("line " + std::to_string(line) + ": " + what);
}

XmlEvent XmlReader::next() {
  attributes_.clear();
  if (closes_at_once_) {
    closes_at_once_ = false;
    open_.pop_back();
    return XmlEvent::close;
  }
  while (ok() && at_ < text_.size()) {
    if (text_[at_] != '<') {
      const std::size_t end = std::min(text_.find('<', at_), text_.size());
      content_ = text_.substr(at_, end - at_);
      at_ = end;
      return XmlEvent::text;
    }
    if (skip_markup()) continue;
    if (ok()) return starts_with("</") ? read_closing() : read_tag();
  }
  if (!open_.empty()) fail("the element " + quoted(open_.back()) + " is not closed");
  return XmlEvent::end;
}

/// Comments and the declaration.
bool XmlReader::skip_markup() {
  const bool is_comment = starts_with("<!--");
  if (!is_comment && starts_with("<!")) fail("document types and CDATA are not read");
  if (!is_comment && !starts_with("<?")) return false;
  const std::string_view ending = is_comment ? "-->" : "?>";
  const std::size_t end = text_.find(ending, at_ + 2);
  if (end == text_.npos) fail("a comment or declaration does not end");
  if (ok()) at_ = end + ending.size();
  return ok();
}

XmlEvent XmlReader::read_closing() {
  at_ += 2;
  name_ = take_name();
  skip_blanks();
  if (!starts_with(">")) fail("a closing tag does not end");
  if (open_.empty() || open_.back() != name_)
    fail("found </" + std::string(name_.substr(0, 40)) + "> too early");
  if (!ok()) return XmlEvent::end;
  ++at_;
  open_.pop_back();
  return XmlEvent::close;
}

XmlEvent XmlReader::read_tag() {
  ++at_;
  name_ = take_name();
  if (name_.empty()) fail("a tag has no name");
  read_attributes();
  closes_at_once_ = starts_with("/>");
  if (!closes_at_once_ && !starts_with(">")) fail("a tag does not end");
  if (open_.size() >= deepest) fail("elements are nested too deeply");
  if (!ok()) return XmlEvent::end;
  at_ += closes_at_once_ ? 2 : 1;
  open_.push_back(name_);
  return XmlEvent::open;
}

void XmlReader::read_attributes() {
  for (skip_blanks(); ok() && at_ < text_.size() && is_name_character(text_[at_]); skip_blanks()) {
    const std::string_view name = take_name();
    if (attribute(name)) fail("the attribute " + quoted(name) + " stands there twice");
    if (attributes_.size() >= most_attributes) fail("an element has too many attributes");
    skip_blanks();
    if (!starts_with("=")) fail("the attribute " + quoted(name) + " has no value");
    if (!ok()) return;
    ++at_;
    skip_blanks();
    std::string value;
    if (!read_value(value))
      return fail("the value of " + quoted(name) + " is not in quotes or not text");
    attributes_.emplace_back(name, std::move(value));
  }
}

bool XmlReader::read_value(std::string& value) {
  struct Entity {
    std::string_view code;
    char character;
  };
  static constexpr std::array<Entity, 5> entities{
      {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}}};
  if (!starts_with("\"") && !starts_with("'")) return false;
  const char quote = text_[at_++];
  while (at_ < text_.size() && text_[at_] != quote) {
    if (text_[at_] == '<') return false;
    const auto* entity =
        std::ranges::find_if(entities, [&](const Entity& e) { return starts_with(e.code); });
    if (text_[at_] == '&' && entity == entities.end()) return false;
    value += entity != entities.end() ? entity->character : text_[at_];
    at_ += entity != entities.end() ? entity->code.size() : 1;
  }
  if (at_ == text_.size()) return false;
  ++at_;
  return true;
}

std::string_view XmlReader::take_name() {
  const std::size_t begin = at_;
  while (at_ < text_.size() && is_name_character(text_[at_])) ++at_;
  return text_.substr(begin, at_ - begin);
}

void XmlReader::skip_blanks() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
}

std::optional<std::string_view> XmlReader::attribute(std::string_view name) const {
  for (const auto& [known, value] : attributes_)
    if (known == name) return value;
  return std::nullopt;
}

}  // namespace souple
