// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "formats/core/result.hpp"
#include "tools/process/child_process.hpp"
#include "tools/surface/mend_steps.hpp"

namespace souple {

/// Far above what a step needs.
inline constexpr ChildLimits step_limits{30, std::size_t{3} << 30};

/// Runs a step in a process of its own: a crash, an exception, an endless loop or a memory glut inside
/// becomes the issue surface_mend_failed, and the mending goes on another way.
Result<MendStep> run_guarded(const std::function<MendStep()>& step,
                             const ChildLimits& limits = step_limits);

}  // namespace souple
