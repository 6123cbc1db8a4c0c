// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/job_pool.hpp"

#include <system_error>

namespace souple {

JobPool::JobPool(unsigned thread_count) {
  for (unsigned k = 1; k < thread_count; ++k) {
    try {
      threads_.emplace_back([this] { work(); });
    } catch (const std::system_error&) {
      return;
    }
  }
}

JobPool::~JobPool() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  begin_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void JobPool::run(std::size_t count, const std::function<void(std::size_t)>& job) {
  {
    const std::lock_guard lock(mutex_);
    job_ = &job;
    count_ = count;
    next_ = 0;
    busy_ = threads_.size();
    ++round_;
  }
  begin_.notify_all();
  take_jobs();
  std::unique_lock lock(mutex_);
  end_.wait(lock, [&] { return busy_ == 0; });
}

void JobPool::take_jobs() {
  for (std::size_t k = next_++; k < count_; k = next_++) (*job_)(k);
}

void JobPool::work() {
  std::size_t seen = 0;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      begin_.wait(lock, [&] { return stopping_ || round_ != seen; });
      if (stopping_) return;
      seen = round_;
    }
    take_jobs();
    const std::lock_guard lock(mutex_);
    if (--busy_ == 0) end_.notify_one();
  }
}

}  // namespace souple
