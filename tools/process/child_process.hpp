// SPDX-License-Identifier: GPL-3.0-or-later
// Work on untrusted bytes in a process of its own.
#pragma once
#include <cstddef>
#include <functional>
#include <string>

#include "formats/core/result.hpp"

namespace souple {

struct ChildLimits {
  double time_s = 60;            ///< wall clock and, a little later, CPU time
  std::size_t memory_bytes = 0;  ///< on top of what the parent has mapped; also limits the answer
};

/// Forks, runs `work` in the child with stdin, stdout and stderr on /dev/null and every other file
/// closed, and returns the bytes it answered. An exception, a crash, a kill, a lasting silence: a coded
/// issue (surface_reader_crashed, _timeout, _memory; io_child_not_started). The answer is as untrusted
/// as the input. With address sanitizers the memory limit is not set: they reserve terabytes.
Result<std::string> run_in_child(const std::function<std::string()>& work, const ChildLimits& limits);

}  // namespace souple
