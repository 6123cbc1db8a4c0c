// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "runtime/world/jobs.hpp"

namespace souple {

/// Threads that wait for the jobs of a world. The one that calls `run` works as well.
class JobPool {
 public:
  /// `thread_count` >= 1, the caller included. A thread that the system refuses is done without.
  explicit JobPool(unsigned thread_count);
  ~JobPool();
  JobPool(const JobPool&) = delete;
  JobPool& operator=(const JobPool&) = delete;

  void run(std::size_t count, const std::function<void(std::size_t)>& job);
  /// For World::run_jobs_with; the pool has to outlive the world's steps.
  RunJobs runner() {
    return [this](std::size_t count, const std::function<void(std::size_t)>& job) { run(count, job); };
  }

 private:
  void work();
  void take_jobs();

  std::mutex mutex_;
  std::condition_variable begin_, end_;
  std::size_t round_ = 0;  ///< of calls of run
  std::size_t busy_ = 0;   ///< threads in this round
  bool stopping_ = false;
  const std::function<void(std::size_t)>* job_ = nullptr;
  std::size_t count_ = 0;
  std::atomic<std::size_t> next_{0};
  std::vector<std::thread> threads_;
};

}  // namespace souple
