// SPDX-License-Identifier: MIT
// How calls of the C interface end: no exception leaves them, and what was refused is kept for the
// thread that asked.
#pragma once
#include <initializer_list>
#include <new>
#include <utility>

#include "formats/core/result.hpp"
#include "runtime/c_api/souple/souple.h"

namespace souple::c_api {

/// Keeps the issue as the last error of this thread, and gives its code.
souple_status keep(const Issue& issue) noexcept;
souple_status keep_out_of_memory() noexcept;
souple_status keep_internal_error() noexcept;

/// The body of a call: a function that gives a Status.
template <class Call>
souple_status guarded(Call&& call) noexcept {
  try {
    const Status status = std::forward<Call>(call)();
    return status ? SOUPLE_OK : keep(status.issue());
  } catch (const std::bad_alloc&) {
    return keep_out_of_memory();
  } catch (...) {
    return keep_internal_error();
  }
}

struct Given {
  const void* pointer;
  const char* name;
};
/// Issue api_argument_missing, naming the first that is null.
Status need(std::initializer_list<Given> given);

inline Issue invalid(std::string what, const char* where) {
  return make_issue(IssueCode::api_argument_invalid, std::move(what), where);
}

}  // namespace souple::c_api
