#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>
#include <unistd.h>

#include "errors.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant::python {

/// The end of the interpreter: nothing may enter it any more but the thread that ends it, which
/// waits for all that are inside of this module. A thread that came back to Python afterwards would
/// be ended there, and the destructors of our frames would free objects without the GIL.
struct Exit {
  static inline std::atomic<bool> has_begun = false;
  static inline std::atomic<std::thread::id> ending_thread = {};

  static bool is_over_here() { return is_over_for(std::this_thread::get_id()); }
  static bool is_over_for(std::thread::id thread) {
    return has_begun && ending_thread.load() != thread;
  }

  static bool has_threads_inside() { return inside > 0; }
  static bool is_inside_here() { return inside_here > 0; }

  static void go_in() {
    if (inside_here++ == 0) ++inside;
  }
  static void go_out() {
    if (--inside_here == 0) --inside;
  }

  /// Never returns. Requires: no GIL.
  [[noreturn]] static void stay() {
    if (is_inside_here()) --inside;
    for (;;) pause();
  }

  /// In a child after a fork there is no thread but the one that forked. It may be inside, if the
  /// work that it does has called a function that forks.
  static void keep_this_thread() { inside = is_inside_here() ? 1 : 0; }

 private:
  // The threads that are in calls of this module, and in how many, one in another, this one is.
  static inline std::atomic<int> inside = 0;
  static inline thread_local int inside_here = 0;
};

/// In a call from Python to this module. Never ends where Python is ending. Requires: the GIL.
class Inside {
 public:
  Inside() {
    if (!Exit::is_inside_here() && Exit::is_over_here()) {
      PyEval_SaveThread();
      Exit::stay();
    }
    Exit::go_in();
  }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;
  ~Inside() { Exit::go_out(); }
};

/// A class of Python whose calls are counted as inside.
template <class... Options>
class Class : public py::class_<Options...> {
 public:
  using Base = py::class_<Options...>;
  using Base::Base;

  template <class... Given>
  Class& def(Given&&... given) {
    Base::def(std::forward<Given>(given)..., py::call_guard<Inside>());
    return *this;
  }
  template <class... Given>
  Class& def_static(Given&&... given) {
    Base::def_static(std::forward<Given>(given)..., py::call_guard<Inside>());
    return *this;
  }
  template <class Getter, class... Given>
  Class& def_property_readonly(const char* name, Getter&& getter, const Given&... given) {
    Base::def_property_readonly(
        name,
        py::cpp_function(py::method_adaptor<typename Base::type>(std::forward<Getter>(getter)),
                         py::call_guard<Inside>()),
        py::return_value_policy::reference_internal, given...);
    return *this;
  }
};

/// A module whose functions' calls are counted as inside.
class Module : public py::module_ {
 public:
  explicit Module(const py::module_& module) : py::module_(module) {}

  template <class... Given>
  Module& def(Given&&... given) {
    py::module_::def(std::forward<Given>(given)..., py::call_guard<Inside>());
    return *this;
  }
};

/// Thrown by what would enter an interpreter that ends.
struct Exiting : std::exception {
  const char* what() const noexcept override {
    return "Python is ending: no other thread may call pliant any more";
  }
};

/// Without the GIL. In a thread that the interpreter does not wait for as it ends, it never ends.
class Released {
 public:
  Released() : state_(PyEval_SaveThread()) {}
  Released(const Released&) = delete;
  Released& operator=(const Released&) = delete;
  ~Released() {
    if (Exit::is_over_here()) Exit::stay();
    PyEval_RestoreThread(state_);
  }

 private:
  PyThreadState* state_;
};

/// With the GIL, in any thread, for a function of Python. Throws Exiting.
class Acquired {
 public:
  Acquired() { Exit::go_in(); }
  Acquired(const Acquired&) = delete;
  Acquired& operator=(const Acquired&) = delete;
  ~Acquired() { Exit::go_out(); }

 private:
  struct Check {
    Check() {
      if (Exit::is_over_here()) throw Exiting();
    }
  } check_;
  py::gil_scoped_acquire acquired_;
};

/// The owners of the functions of Python that this thread is in, the innermost first.
class InCallback {
 public:
  explicit InCallback(const void* owner) : owner_(owner), outer_(innermost) { innermost = this; }
  InCallback(const InCallback&) = delete;
  InCallback& operator=(const InCallback&) = delete;
  ~InCallback() { innermost = outer_; }

  static bool is_of(const void* owner) {
    for (const InCallback* each = innermost; each != nullptr; each = each->outer_)
      if (each->owner_ == owner) return true;
    return false;
  }

 private:
  const void* owner_;
  const InCallback* outer_;
  static inline thread_local const InCallback* innermost = nullptr;
};

/// A Python object that C++ may copy and destroy without the GIL.
using Held = std::shared_ptr<py::object>;

inline Held held(py::object object) {
  return {new py::object(std::move(object)), [](py::object* own) {
            if (!Py_IsInitialized() || Exit::is_over_here()) return;  // it has freed it
            const py::gil_scoped_acquire acquired;
            delete own;  // NOLINT
          }};
}

/// What long work asks whether to go on: Ctrl-C, `should_stop`, `interrupt()`. One for each object
/// that works; it has all functions of Python that the work calls.
class Asking {
 public:
  Asking() = default;
  explicit Asking(const py::object& should_stop)
      : should_stop_(should_stop.is_none() ? nullptr : keep(should_stop)) {}

  /// A function that the work will call.
  Held keep(py::object function) {
    functions_.push_back(held(std::move(function)));
    return functions_.back();
  }

  /// The functions, for the collector of garbage: each is referred to once.
  const std::vector<Held>& functions() const { return functions_; }

  /// Lets the functions go: the object is garbage, and will not work any more.
  void let_go() {
    for (const Held& function : functions_) *function = py::none();
  }

  bool is_of_parent() const { return process_ != getpid(); }

  /// Raises RuntimeError in a child after a fork.
  void check_process() const {
    if (is_of_parent())
      throw std::runtime_error("this belongs to the parent process; make another one after a fork");
  }

  /// For the options of the library; this object must outlive the work.
  StopRequest request() {
    return [this] { return wants_stop(); };
  }

  void interrupt() {
    if (is_running_) is_interrupted_ = true;
  }

 private:
  friend class Turn;

  bool wants_stop() {
    // The thread that ends the interpreter may still call, and its work may have other threads.
    if (is_interrupted_ || has_error_ || Exit::is_over_for(caller_)) return true;
    if (std::this_thread::get_id() == caller_ && Clock::now() >= next_look_) {
      const Acquired acquired;
      if (PyErr_CheckSignals() != 0) return store_error();
      next_look_ = Clock::now() + std::chrono::milliseconds(20);
    }
    if (!should_stop_) return false;
    if (Exit::is_over_here()) return true;
    const Acquired acquired;
    const InCallback callback(this);
    try {
      return py::bool_((*should_stop_)());
    } catch (py::error_already_set&) {
      return store_error(std::current_exception());
    }
  }

  bool store_error(std::exception_ptr error = nullptr) {
    if (!error) {
      try {
        throw py::error_already_set();
      } catch (...) {
        error = std::current_exception();
      }
    }
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = std::move(error);
    return has_error_ = true;
  }

  using Clock = std::chrono::steady_clock;

  std::vector<Held> functions_;
  Held should_stop_;
  std::atomic<bool> is_running_ = false, is_interrupted_ = false, has_error_ = false;
  std::thread::id caller_;
  Clock::time_point next_look_;  // of the caller alone
  std::mutex mutex_;             // guards the error
  std::exception_ptr error_;
  std::mutex turns_;  // guards the owner
  std::condition_variable turn_is_over_;
  std::thread::id owner_;  // whose turn it is; none
  pid_t process_ = getpid();
};

/// A call on an object that works: one at a time, others wait without the GIL, and Ctrl-C ends
/// their wait. Raises RuntimeError if the call comes from a function that the object has called,
/// from what this thread does within another call, such as a handler of a signal, or from a child
/// after a fork.
class Turn {
 public:
  explicit Turn(Asking& asking) : asking_(asking) {
    asking.check_process();
    while (!take()) {
      const Released released;
      std::unique_lock lock(asking.turns_);
      asking.turn_is_over_.wait_for(lock, std::chrono::milliseconds(20));
    }
    asking.caller_ = std::this_thread::get_id();
    asking.next_look_ = {};
    asking.is_interrupted_ = asking.has_error_ = false;
    asking.error_ = nullptr;
    asking.is_running_ = true;
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;
  ~Turn() {
    asking_.is_running_ = false;
    const std::lock_guard lock(asking_.turns_);
    asking_.owner_ = {};
    asking_.turn_is_over_.notify_one();
  }

  /// The result of work without the GIL. Raises what stopped it, and its error.
  template <class Work>
  auto run(Work&& work) {
    auto result = [&] {
      const Released released;
      return work();
    }();
    if (asking_.has_error_) {
      const std::lock_guard lock(asking_.mutex_);
      std::rethrow_exception(std::exchange(asking_.error_, nullptr));
    }
    return taken(std::move(result));
  }

 private:
  // Whether it is this thread's turn now.
  bool take() {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    const std::lock_guard lock(asking_.turns_);
    if (asking_.owner_ == std::this_thread::get_id() || InCallback::is_of(&asking_))
      throw std::runtime_error("it is called from a function that it has called itself");
    if (asking_.owner_ != std::thread::id()) return false;
    asking_.owner_ = std::this_thread::get_id();
    return true;
  }

  Asking& asking_;
};

/// Work of one call: the result without the GIL, which Ctrl-C stops. `work(should_stop)`.
template <class Work>
auto run_once(Work&& work, const py::object& should_stop = py::none()) {
  Asking asking(should_stop);
  Turn turn(asking);
  return turn.run([&] { return work(asking.request()); });
}

}  // namespace pliant::python
