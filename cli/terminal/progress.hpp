#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace pliant::cli {

/// If this variable is set, progress is also told to a program that reads our messages: lines
/// `12/96` on stderr.
inline constexpr const char* progress_variable = "PLIANT_PROGRESS";

/// A bar on stderr with frames, or takes, done and per second, and the time left; not shown if
/// stderr is not a terminal.
class Progress {
 public:
  Progress(int count, bool is_quiet, std::string_view unit = "frames");
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();  ///< erases the bar

  bool is_shown() const { return is_shown_; }

  /// Counts one more frame. Draws at most ten times a second.
  void advance() { reach(done_ + 1); }

  /// So many frames are done. Draws at most ten times a second.
  void reach(int done);

  /// The time by which frames per second and the time left are told begins now.
  void begin_again() { begin_ = Clock::now(); }

  /// What stands at the end of the bar from now on.
  void add_note(std::string note) { note_ = std::move(note); }

 private:
  using Clock = std::chrono::steady_clock;

  void draw_bar(Clock::time_point now) const;

  int count_;
  std::string unit_;
  std::string note_ = {};
  int done_ = 0;
  bool is_shown_;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point drawn_ = {};
};

/// A line on stderr with the work that goes on and a bar of how much of it is done; not shown if
/// stderr is not a terminal.
class WorkLine {
 public:
  explicit WorkLine(bool is_quiet);
  WorkLine(const WorkLine&) = delete;
  WorkLine& operator=(const WorkLine&) = delete;
  ~WorkLine() { erase(); }

  void erase();  ///< until more is told

  /// For `SimulationOptions::progressed`: draws the line at most ten times a second. Empty if it
  /// would not be shown. The line outlives it.
  std::function<void(const std::string& work, int done, int count)> report();

  /// The same for `SimulationOptions::round_done`.
  std::function<void(std::string_view surface, int round, double gap)> report_of_rounds();

 private:
  void tell(const std::string& line);

  using Clock = std::chrono::steady_clock;

  std::mutex mutex_;  // several surfaces are solved in parallel
  bool is_shown_, is_drawn_ = false;
  Clock::time_point drawn_ = {};
};

/// For `SimulationOptions::round_done`: a line on stderr that the bar replaces, drawn at most ten
/// times a second. Empty if it would not be shown.
std::function<void(std::string_view surface, int round, double gap)> round_line(bool is_quiet);

}  // namespace pliant::cli
