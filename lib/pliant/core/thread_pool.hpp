#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

namespace pliant {

/// Threads that wait for work. Results must not depend on which thread does which work, or in which
/// order; then they do not depend on the number of threads. SPEC 10.
class ThreadPool {
 public:
  /// `threads` in total, including the calling one; 1 starts none. Fewer if the system refuses to
  /// start that many. Requires: threads >= 1.
  explicit ThreadPool(int threads);
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;
  int thread_count() const { return static_cast<int>(threads_.size()) + 1; }

  /// Calls work(0) to work(count - 1), each once, some of them at the same time, and returns when
  /// all are done. Rethrows the exception of the smallest index. Not thread-safe. Work must not
  /// call it, unless count is 1.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& work);

 private:
  struct Failure {
    std::size_t index = 0;
    std::exception_ptr exception;
  };

  void wait_for_work(const std::stop_token& stop);
  void take_part();

  std::mutex mutex_;
  std::condition_variable_any work_is_there_;
  std::condition_variable work_is_done_;
  const std::function<void(std::size_t)>* work_ = nullptr;
  std::size_t count_ = 0;
  std::size_t next_ = 0;  // the next index to start
  std::size_t done_ = 0;
  Failure failure_;
  std::vector<std::jthread> threads_;  // last: they use all of the above, and are stopped first
};

/// The same by some threads; null: by the calling one alone, in order.
template <class Work>
void for_each(ThreadPool* threads, std::size_t count, const Work& work) {
  if (threads) return threads->for_each(count, std::ref(work));
  for (std::size_t k = 0; k < count; ++k) work(k);
}

}  // namespace pliant
