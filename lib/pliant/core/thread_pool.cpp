#include "pliant/core/thread_pool.hpp"

#include <new>
#include <system_error>
#include <utility>

#include "pliant/core/expects.hpp"

namespace pliant {

ThreadPool::ThreadPool(int threads) {
  PLIANT_EXPECTS(threads >= 1);
  try {
    for (int k = 1; k < threads; ++k) {
      threads_.emplace_back([this](const std::stop_token& stop) { wait_for_work(stop); });
    }
  } catch (const std::system_error&) {
    // The system refuses to start more threads: use those that exist.
  } catch (const std::bad_alloc&) {
  }
}

void ThreadPool::for_each(std::size_t count, const std::function<void(std::size_t)>& work) {
  if (count <= 1 || threads_.empty()) {
    for (std::size_t index = 0; index < count; ++index) work(index);
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    work_ = &work;
    count_ = count;
    next_ = done_ = 0;
    failure_ = {};
  }
  work_is_there_.notify_all();
  take_part();
  std::unique_lock lock(mutex_);
  work_is_done_.wait(lock, [this] { return done_ == count_; });
  work_ = nullptr;
  count_ = next_ = 0;
  if (failure_.exception) std::rethrow_exception(std::exchange(failure_.exception, nullptr));
}

void ThreadPool::wait_for_work(const std::stop_token& stop) {
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      if (!work_is_there_.wait(lock, stop, [this] { return next_ < count_; })) return;
    }
    take_part();
  }
}

// Does the work that no thread has started yet, one index after another.
void ThreadPool::take_part() {
  std::unique_lock lock(mutex_);
  while (next_ < count_) {
    const std::size_t index = next_++;
    const auto& work = *work_;
    lock.unlock();
    std::exception_ptr exception;
    try {
      work(index);
    } catch (...) {
      exception = std::current_exception();
    }
    lock.lock();
    if (exception && (!failure_.exception || index < failure_.index)) {
      failure_ = {index, exception};
    }
    if (++done_ == count_) work_is_done_.notify_all();
  }
}

}  // namespace pliant
