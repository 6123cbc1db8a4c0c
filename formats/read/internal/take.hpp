// SPDX-License-Identifier: MIT
// How the parts of a group are put together: the first issue ends the reading.
#pragma once
#include <utility>

#include "formats/core/result.hpp"
#include "formats/read/internal/issue_list.hpp"

namespace souple::storage {

/// Moves a part of the file into its place; false leaves the issue in `status`. Reads of one group are
/// chained with &&, the first that fails ends the chain.
template <class T>
bool take(Result<T> part, T& place, Status& status) {
  if (part)
    place = std::move(part).value();
  else
    status = part.issue();
  return status.ok();
}

/// The part, or the first thing a check found in it.
template <class Part>
Result<Part> checked(Part part, const IssueList& issues) {
  if (!issues.empty()) return issues.front();
  return part;
}

inline IssueList first_issue_only() { return IssueList(ValidationOptions{1}); }

}  // namespace souple::storage
