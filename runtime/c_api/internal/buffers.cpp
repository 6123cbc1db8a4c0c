// SPDX-License-Identifier: MIT
#include "runtime/c_api/internal/buffers.hpp"

namespace souple::c_api {
namespace {

constexpr std::size_t largest_struct = 65536;  // bytes: far beyond any version of any struct

}  // namespace

Result<bool> may_fill(const void* buffer, std::size_t capacity, std::size_t* needed,
                      std::size_t count) {
  if (!buffer && (capacity > 0 || !needed)) return need({{buffer, "buffer"}}).issue();
  if (needed) *needed = count;
  if (!buffer) return false;
  if (capacity < count)
    return make_issue(
        IssueCode::api_buffer_too_small,
        "the buffer has room for " + std::to_string(capacity) + " entries of " + std::to_string(count),
        "buffer");
  return true;
}

Status check_struct_size(std::size_t size, std::size_t first, const char* name) {
  if (size >= first && size <= largest_struct) return {};
  return make_issue(IssueCode::api_struct_size_invalid,
                    "struct_size is " + std::to_string(size) + ", the struct has " +
                        std::to_string(first) + " bytes or more",
                    name);
}

Status check_rest(const void* given, std::size_t size, std::size_t known, const char* name) {
  const auto* bytes = static_cast<const unsigned char*>(given);
  for (std::size_t i = known; i < size; ++i)
    if (bytes[i] != 0)
      return make_issue(IssueCode::api_struct_size_invalid,
                        "the struct has fields beyond byte " + std::to_string(known) +
                            " that this version does not know",
                        name);
  return {};
}

}  // namespace souple::c_api
