// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <functional>
#include <memory>

namespace souple {

/// Threads that share out the items of one loop at a time. Which thread takes which item is left open,
/// so items must not depend on each other, nor on the thread.
class WorkerPool {
 public:
  /// The calling thread is one of `threads` (0 counts as 1).
  explicit WorkerPool(unsigned threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  unsigned threads() const;
  /// work(item, worker) for every item in [0, count), taken in ascending order; returns when all are
  /// done. Worker 0 is the calling thread. What `work` throws is thrown again here, once all have
  /// ended.
  void run(std::size_t count, const std::function<void(std::size_t item, unsigned worker)>& work);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace souple
