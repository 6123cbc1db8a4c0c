// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <string>

#include "formats/read/validate.hpp"

namespace souple {

/// Collects issues up to a cap; the text of an issue past it is never put together.
class IssueList {
 public:
  explicit IssueList(const ValidationOptions& options)
      : cap_(std::max<std::size_t>(options.issue_cap, 1)) {}

  void add(Issue issue) {
    if (report_.issues.size() < cap_)
      report_.issues.push_back(std::move(issue));
    else
      ++report_.suppressed_count;
  }
  /// `what` returns the text.
  template <class What>
  void add(IssueCode code, const std::string& where, const What& what) {
    if (report_.issues.size() < cap_)
      report_.issues.push_back(make_issue(code, what(), where));
    else
      ++report_.suppressed_count;
  }

  bool empty() const { return report_.issues.empty(); }
  std::size_t count() const { return report_.issues.size() + report_.suppressed_count; }
  const Issue& front() const { return report_.issues.front(); }
  ValidationReport take() { return std::move(report_); }

 private:
  ValidationReport report_;
  std::size_t cap_;
};

}  // namespace souple
