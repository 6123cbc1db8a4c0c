// SPDX-License-Identifier: MIT
#include "runtime/c_api/internal/refusal.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

namespace souple::c_api {
namespace {

/// Fixed arrays: to keep an error allocates nothing and cannot fail.
struct LastError {
  souple_status code = SOUPLE_OK;
  std::array<char, 1024> what{};
  std::array<char, 512> where{}, mend{};
};

thread_local LastError last;

template <std::size_t size>
void copy(std::array<char, size>& to, std::string_view from) {
  std::size_t length = std::min(from.size(), size - 1);
  // A text that is cut ends before the character that it would split: not at a continuation byte.
  if (length < from.size())
    while (length > 0 && (static_cast<unsigned char>(from[length]) & 0xC0) == 0x80) --length;
  std::memcpy(to.data(), from.data(), length);
  to[length] = '\0';
}

souple_status keep_parts(IssueCode code, std::string_view what, std::string_view where,
                         std::string_view mend) {
  last.code = static_cast<souple_status>(code);
  copy(last.what, what);
  copy(last.where, where);
  copy(last.mend, mend);
  return last.code;
}

souple_status keep_entry(IssueCode code) {
  const IssueEntry& entry = issue_entry(code);
  return keep_parts(code, entry.title, "", entry.mend);
}

}  // namespace

souple_status keep(const Issue& issue) noexcept {
  return keep_parts(issue.code, issue.what, issue.where, mend_of(issue));
}
souple_status keep_out_of_memory() noexcept { return keep_entry(IssueCode::io_out_of_memory); }
souple_status keep_internal_error() noexcept { return keep_entry(IssueCode::internal_error); }

Status need(std::initializer_list<Given> given) {
  for (const Given& argument : given)
    if (!argument.pointer)
      return make_issue(IssueCode::api_argument_missing, std::string("`") + argument.name + "` is NULL",
                        argument.name);
  return {};
}

}  // namespace souple::c_api

using souple::c_api::last;

extern "C" {

souple_status souple_last_error_code(void) { return last.code; }
const char* souple_last_error_what(void) { return last.what.data(); }
const char* souple_last_error_where(void) { return last.where.data(); }
const char* souple_last_error_mend(void) { return last.mend.data(); }

}  // extern "C"
