#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace pliant::editor {

/// A thread that does one thing after the other. What throws, for lack of memory, ends there, and
/// the next thing is done. Thread-safe.
class Worker {
 public:
  Worker() = default;
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker() { end(); }

  /// Call once. `idle` is called now and then, also between things to do.
  void begin(std::function<void()> idle = {});
  /// Also before it begins.
  void add(std::function<void()> work);
  /// What was not begun is not done.
  void end();

 private:
  void run();

  std::function<void()> idle_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> work_;
  bool is_ending_ = false;
  std::thread thread_;
};

}  // namespace pliant::editor
