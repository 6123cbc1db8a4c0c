// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/compliance_stage.hpp"

#include <string>

#include "tools/cli/json_output.hpp"
#include "tools/cli/signals.hpp"

namespace souple {

Status run_compliance_stage(BakeOutcome& outcome, const Recipe& recipe, ComplianceStage stage,
                            ProgressSink& progress, Console& console, bool json,
                            const std::function<std::string()>& kept) {
  const InterruptFlag interrupt;
  stage.cancelled = [&] { return interrupt.raised(); };
  Status done = add_compliances(outcome, recipe, stage, progress);
  console.end_progress();
  if (done && interrupt.raised()) {
    if (stage.keep) (void)stage.keep(outcome.asset);
    done = make_issue(IssueCode::interrupted, "a signal came while the last compliance was computed");
  }
  if (done || done.issue().code != IssueCode::interrupted) return done;
  console.issue(done.issue());
  if (const std::string text = kept ? kept() : ""; !text.empty()) console.say(text);
  if (json) (void)print_json(stopped_json(done.issue()));
  interrupt.pass_on();
  return done;
}

Status write_held(BakeOutcome& outcome, const std::string& file, ProgressSink& progress) {
  const HeldSignals held;
  return write_baked_asset(outcome, file, progress);
}

}  // namespace souple
