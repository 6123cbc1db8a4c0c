// SPDX-License-Identifier: MIT
#include <algorithm>

#include "formats/core/issue.hpp"
#include "runtime/c_api/souple/souple.h"

namespace {

// The catalogue's texts are literals: each ends with 0.
const souple::IssueEntry* find_entry(souple_status code) {
  const auto catalogue = souple::issue_catalogue();
  const auto found = std::ranges::lower_bound(
      catalogue, code, {}, [](const auto& entry) { return static_cast<souple_status>(entry.code); });
  return found != catalogue.end() && static_cast<souple_status>(found->code) == code ? &*found
                                                                                     : nullptr;
}

const char* text_of(souple_status code, std::string_view souple::IssueEntry::*part, const char* of_ok) {
  if (code == SOUPLE_OK) return of_ok;
  const souple::IssueEntry* entry = find_entry(code);
  return entry ? (entry->*part).data() : nullptr;
}

}  // namespace

extern "C" {

const char* souple_issue_text(souple_status code) {
  return text_of(code, &souple::IssueEntry::title, "ok");
}

const char* souple_issue_name(souple_status code) {
  return text_of(code, &souple::IssueEntry::name, "ok");
}

const char* souple_issue_explanation(souple_status code) {
  return text_of(code, &souple::IssueEntry::explanation, "Nothing was refused.");
}

const char* souple_issue_mend(souple_status code) {
  return text_of(code, &souple::IssueEntry::mend, "");
}

size_t souple_issue_count(void) { return souple::issue_catalogue().size(); }

souple_status souple_issue_at(size_t index) {
  const auto catalogue = souple::issue_catalogue();
  return index < catalogue.size() ? static_cast<souple_status>(catalogue[index].code) : SOUPLE_OK;
}

}  // extern "C"
