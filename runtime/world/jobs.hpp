// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <functional>

namespace souple {

/// Calls job(0) ... job(count - 1), each once, in any order and on any threads of the application, and
/// returns when all are done. Jobs of one call touch nothing in common, and do not throw.
using RunJobs = std::function<void(std::size_t count, const std::function<void(std::size_t)>& job)>;

}  // namespace souple
