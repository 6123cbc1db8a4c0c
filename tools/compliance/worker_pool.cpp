// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/compliance/worker_pool.hpp"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace souple {

struct WorkerPool::State {
  using Work = std::function<void(std::size_t, unsigned)>;

  std::mutex mutex;
  std::condition_variable started, ended;
  std::uint64_t loop = 0;  ///< counts the loops that were begun
  std::size_t busy = 0;    ///< helpers that have not ended the current loop
  bool stopping = false;
  const Work* work = nullptr;
  std::size_t count = 0;
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::vector<std::jthread> helpers;

  void take_items(unsigned worker) {
    try {
      for (std::size_t item; (item = next++) < count;) (*work)(item, worker);
    } catch (...) {
      next = count;
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  }

  void serve(unsigned worker) {
    std::uint64_t seen = 0;
    for (std::unique_lock lock(mutex);;) {
      started.wait(lock, [&] { return stopping || loop != seen; });
      if (stopping) return;
      seen = loop;
      lock.unlock();
      take_items(worker);
      lock.lock();
      if (--busy == 0) ended.notify_one();
    }
  }
};

WorkerPool::WorkerPool(unsigned threads) : state_(std::make_unique<State>()) {
  for (unsigned worker = 1; worker < threads; ++worker)
    state_->helpers.emplace_back([state = state_.get(), worker] { state->serve(worker); });
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->stopping = true;
  }
  state_->started.notify_all();
  state_->helpers.clear();
}

unsigned WorkerPool::threads() const { return static_cast<unsigned>(state_->helpers.size()) + 1; }

void WorkerPool::run(std::size_t count, const std::function<void(std::size_t, unsigned)>& work) {
  if (count <= 1 || state_->helpers.empty()) {
    for (std::size_t item = 0; item < count; ++item) work(item, 0);
    return;
  }
  {
    const std::lock_guard lock(state_->mutex);
    state_->work = &work;
    state_->count = count;
    state_->next = 0;
    state_->failure = nullptr;
    state_->busy = state_->helpers.size();
    ++state_->loop;
  }
  state_->started.notify_all();
  state_->take_items(0);
  std::unique_lock lock(state_->mutex);
  state_->ended.wait(lock, [&] { return state_->busy == 0; });
  if (state_->failure) std::rethrow_exception(std::exchange(state_->failure, nullptr));
}

}  // namespace souple
