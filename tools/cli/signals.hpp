// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <csignal>

namespace souple {

/// Process-wide: a write past a file-size limit becomes an error instead of a signal.
void report_write_limits_as_errors();

/// Holds SIGINT, SIGTERM and SIGHUP back while a file is written, so that its temporary copy never
/// stays behind; the last of them arrives at the end of the scope. By handlers and not by a mask: a
/// mask is one thread's, and a signal to the process goes to any worker of a library that does not
/// block it.
class HeldSignals {
 public:
  HeldSignals();
  ~HeldSignals();
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

 private:
  std::array<struct sigaction, 3> before_;
};

/// From here on the first SIGINT or SIGTERM only raises a flag; the second one ends the process.
class InterruptFlag {
 public:
  InterruptFlag();
  ~InterruptFlag();
  InterruptFlag(const InterruptFlag&) = delete;
  InterruptFlag& operator=(const InterruptFlag&) = delete;
  bool raised() const;
  /// Ends the process by the signal that came, as its caller expects.
  void pass_on() const;

 private:
  struct sigaction before_interrupt_ {};
  struct sigaction before_terminate_ {};
};

}  // namespace souple
