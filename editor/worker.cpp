#include "editor/worker.hpp"

#include <chrono>
#include <utility>

namespace pliant::editor {

namespace {

void attempt(const std::function<void()>& work) {
  try {
    if (work) work();
  } catch (...) {
    // Whoever waits for it learns of it when the work is gone.
  }
}

}  // namespace

void Worker::begin(std::function<void()> idle) {
  idle_ = std::move(idle);
  thread_ = std::thread([this] { run(); });
}

void Worker::add(std::function<void()> work) {
  {
    const std::lock_guard lock(mutex_);
    work_.push_back(std::move(work));
  }
  changed_.notify_all();
}

void Worker::end() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Worker::run() {
  for (;;) {
    std::function<void()> work;
    {
      constexpr auto rest = std::chrono::milliseconds(100);  // between two calls of `idle_`
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, rest, [&] { return is_ending_ || !work_.empty(); });
      if (is_ending_) return;
      if (!work_.empty()) {
        work = std::move(work_.front());
        work_.pop_front();
      }
    }
    attempt(work);
    work = {};
    attempt(idle_);
  }
}

}  // namespace pliant::editor
