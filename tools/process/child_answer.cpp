// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/process/child_answer.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace souple {
namespace {

constexpr std::uint64_t magic = 0x3152574e53504c53;
constexpr std::size_t longest_text = 1000;

/// Native byte order: both ends are one program.
struct Header {
  std::uint64_t magic;
  std::uint64_t issue_code;  ///< 0: the bytes of an answer follow, else the text of the issue
  std::uint64_t body_bytes;
  std::uint64_t checksum;  ///< XXH3 of the body
};

Issue damaged() {
  return make_issue(IssueCode::surface_reader_crashed, "the reader's answer is damaged");
}

}  // namespace

std::string seal_answer(const Result<std::string>& answer) {
  Header header{};
  header.magic = magic;
  const std::string text = answer ? std::string() : answer.issue().what.substr(0, longest_text);
  if (!answer) header.issue_code = static_cast<std::uint64_t>(answer.issue().code);
  const std::string& body = answer ? *answer : text;
  header.body_bytes = body.size();
  header.checksum = XXH3_64bits(body.data(), body.size());
  std::string sealed;
  sealed.reserve(sizeof header + body.size());
  sealed.append(reinterpret_cast<const char*>(&header), sizeof header);
  return sealed += body;
}

Result<std::string_view> open_answer(std::string_view sealed) {
  Header header;
  if (sealed.size() < sizeof header) return damaged();
  std::memcpy(&header, sealed.data(), sizeof header);
  sealed.remove_prefix(sizeof header);
  if (header.magic != magic || header.body_bytes != sealed.size() ||
      header.checksum != XXH3_64bits(sealed.data(), sealed.size()))
    return damaged();
  if (header.issue_code == 0) return sealed;
  const IssueEntry* entry = find_issue_entry(std::to_string(header.issue_code));
  if (entry == nullptr) return damaged();
  std::string printable(sealed.substr(0, longest_text));
  std::ranges::replace_if(
      printable, [](unsigned char c) { return c < 32 || c == 127; }, ' ');
  return make_issue(entry->code, printable);
}

}  // namespace souple
