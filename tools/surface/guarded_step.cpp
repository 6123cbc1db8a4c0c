// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/guarded_step.hpp"

#include <string>
#include <utility>

#include "tools/surface/soup_transfer.hpp"

namespace souple {
namespace {

/// The child speaks of a reader; here it was a step of mending.
Issue issue_of_step(const Issue& issue) {
  const auto failed = [&](const char* what) {
    return make_issue(IssueCode::surface_mend_failed, what + (" (" + issue.what + ")"));
  };
  switch (issue.code) {
    case IssueCode::surface_reader_crashed:
      return failed("it crashed");
    case IssueCode::surface_reader_timeout:
      return failed("it took too long");
    case IssueCode::surface_reader_memory:
      return failed("it needed too much memory");
    default:
      return issue;
  }
}

}  // namespace

Result<MendStep> run_guarded(const std::function<MendStep()>& step, const ChildLimits& limits) {
  const Result<std::string> answer = run_in_child(
      [&] {
        MendStep done = step();
        TriangleSoup soup;
        soup.mesh = std::move(done.mesh);
        soup.raw_polygon_count = done.count;
        return pack_answer(soup);
      },
      limits);
  if (!answer) return issue_of_step(answer.issue());
  Result<TriangleSoup> soup = unpack_answer(*answer);
  if (!soup) return issue_of_step(soup.issue());
  return MendStep{std::move(soup->mesh), soup->raw_polygon_count};
}

}  // namespace souple
