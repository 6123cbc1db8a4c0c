// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/signals.hpp"

namespace souple {
namespace {

volatile std::sig_atomic_t caught_signal = 0;

volatile std::sig_atomic_t held_signal = 0;
constexpr std::array<int, 3> held_numbers{SIGINT, SIGTERM, SIGHUP};

extern "C" void remember_signal(int signal) { caught_signal = signal; }
extern "C" void hold_signal(int signal) { held_signal = signal; }

}  // namespace

void report_write_limits_as_errors() { std::signal(SIGXFSZ, SIG_IGN); }

HeldSignals::HeldSignals() {
  held_signal = 0;
  struct sigaction action {};
  action.sa_handler = hold_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < held_numbers.size(); ++i)
    sigaction(held_numbers[i], &action, &before_[i]);
}

HeldSignals::~HeldSignals() {
  for (std::size_t i = 0; i < held_numbers.size(); ++i)
    sigaction(held_numbers[i], &before_[i], nullptr);
  if (held_signal != 0) std::raise(held_signal);
}

InterruptFlag::InterruptFlag() {
  caught_signal = 0;
  struct sigaction action {};
  action.sa_handler = remember_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, &before_interrupt_);
  sigaction(SIGTERM, &action, &before_terminate_);
}

InterruptFlag::~InterruptFlag() {
  sigaction(SIGINT, &before_interrupt_, nullptr);
  sigaction(SIGTERM, &before_terminate_, nullptr);
}

bool InterruptFlag::raised() const { return caught_signal != 0; }

void InterruptFlag::pass_on() const {
  if (caught_signal == 0) return;
  std::signal(caught_signal, SIG_DFL);
  std::raise(caught_signal);
}

}  // namespace souple
