// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <atomic>
#include <cstdint>

namespace souple {

/// Hands values from one thread to another: the reader gets the newest one that was finished. Neither
/// side ever waits, copies or allocates.
template <class T>
class TripleBuffer {
 public:
  /// Writer: a value to be filled in, which the reader does not see ...
  T& back() { return slots_[back_]; }
  /// ... until here.
  void publish() {
    back_ = middle_.exchange(std::uint8_t(back_ | fresh), std::memory_order_acq_rel) & index;
  }

  /// Reader: whether there is a newer value; front() is then that one.
  bool take() {
    if (!(middle_.load(std::memory_order_relaxed) & fresh)) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & index;
    return true;
  }
  const T& front() const { return slots_[front_]; }

  /// Before both threads begin.
  template <class Visit>
  void for_each_slot(Visit&& visit) {
    for (T& slot : slots_) visit(slot);
  }

 private:
  static constexpr std::uint8_t fresh = 4, index = 3;
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free);
  // Each side writes its own line of cache.
  alignas(64) std::array<T, 3> slots_{};
  alignas(64) std::uint8_t back_ = 0;
  alignas(64) std::atomic<std::uint8_t> middle_{1};
  alignas(64) std::uint8_t front_ = 2;
};

}  // namespace souple
