// SPDX-License-Identifier: MIT
#include <string>

#include "runtime/c_api/internal/refusal.hpp"

namespace {

#define SOUPLE_TEXT_OF(x) #x
#define SOUPLE_VERSION_TEXT(major, minor, patch) \
  SOUPLE_TEXT_OF(major) "." SOUPLE_TEXT_OF(minor) "." SOUPLE_TEXT_OF(patch)
constexpr const char* version_text =
    SOUPLE_VERSION_TEXT(SOUPLE_VERSION_MAJOR, SOUPLE_VERSION_MINOR, SOUPLE_VERSION_PATCH);

static_assert(std::string_view(version_text) == SOUPLE_PROJECT_VERSION,
              "souple.h names another version than the project");
static_assert(SOUPLE_ABI_VERSION == SOUPLE_PROJECT_ABI, "souple.h names another ABI than the library");

}  // namespace

extern "C" {

void souple_version(int32_t* major, int32_t* minor, int32_t* patch) {
  if (major) *major = SOUPLE_VERSION_MAJOR;
  if (minor) *minor = SOUPLE_VERSION_MINOR;
  if (patch) *patch = SOUPLE_VERSION_PATCH;
}

const char* souple_version_string(void) { return version_text; }

int32_t souple_abi_version(void) { return SOUPLE_ABI_VERSION; }

souple_status souple_check_abi(int32_t abi_version, int32_t version_major, int32_t version_minor) {
  return souple::c_api::guarded([&]() -> souple::Status {
    const bool older = version_major < SOUPLE_VERSION_MAJOR ||
                       (version_major == SOUPLE_VERSION_MAJOR && version_minor <= SOUPLE_VERSION_MINOR);
    if (abi_version == SOUPLE_ABI_VERSION && older && version_major >= 0 && version_minor >= 0)
      return {};
    return souple::make_issue(souple::IssueCode::api_version_mismatch,
                              "the program wants ABI " + std::to_string(abi_version) + " of version " +
                                  std::to_string(version_major) + "." + std::to_string(version_minor) +
                                  ", the library has ABI " + std::to_string(SOUPLE_ABI_VERSION) +
                                  " of version " + version_text);
  });
}

}  // extern "C"
