// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/compliance_options.hpp"

#include <algorithm>
#include <thread>

#include "tools/cli/command_line.hpp"

namespace souple {
namespace {

constexpr std::int64_t least_mb = 16, most_mb = 16'000'000, most_threads = 256;

}  // namespace

void ComplianceOptions::add_to(CLI::App& app) {
  app.add_option("--time-step-s", overrides_.time_step_s, "time step of the dynamic compliance");
  app.add_option("--tolerance", overrides_.tolerance,
                 "largest error of stored compliances (0.001), at most 0.5; 0: dense, uncompressed");
  app.add_option("--scalar", overrides_.scalar,
                 "store compliances dense, as float32 or float64 (as tolerance 0 does)");
  effort_.add_to(app);
}

void EffortOptions::add_to(CLI::App& app) {
  app.add_option("--memory-mb", memory_mb_,
                 "memory that computing a compliance may take, in 10^6 bytes (17180)");
  app.add_option("--threads", threads_, "threads for compliances; the result does not depend on them");
}

Result<ComplianceStage> EffortOptions::stage() const {
  ComplianceStage stage;
  stage.threads = std::clamp(std::thread::hardware_concurrency(), 1U, unsigned{most_threads});
  if (memory_mb_) {
    const auto mb = integer_option("--memory-mb", *memory_mb_, least_mb, most_mb);
    if (!mb) return mb.issue();
    stage.memory_limit_bytes = static_cast<std::size_t>(*mb) * 1'000'000;
  }
  if (threads_) {
    const auto threads = integer_option("--threads", *threads_, 1, most_threads);
    if (!threads) return threads.issue();
    stage.threads = static_cast<unsigned>(*threads);
  }
  return stage;
}

}  // namespace souple
