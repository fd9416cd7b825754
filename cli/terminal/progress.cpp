#include "cli/terminal/progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

namespace pliant::cli {
namespace {

// Replaces the present line: the only output with terminal control sequences.
void draw(const std::string& line) {
  const std::string text = "\r\033[K" + line;
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

// So much is done of `count`.
std::string bar_of(int done, int count) {
  constexpr int width = 30;
  const int filled = static_cast<int>(static_cast<long>(width) * done / std::max(1, count));
  return fmt::format("[{}{}] {}/{}", std::string(filled, '#'), std::string(width - filled, '.'),
                     done, count);
}

// Whether a program reads the progress, in place of a person.
bool is_for_program() {
  static const bool is_asked = std::getenv(progress_variable) != nullptr;
  return is_asked;
}

bool is_visible(bool is_quiet) { return !is_quiet && isatty(STDERR_FILENO) != 0; }

}  // namespace

Progress::Progress(int count, bool is_quiet, std::string_view unit)
    : count_(count), unit_(unit), is_shown_(is_visible(is_quiet)) {}

Progress::~Progress() {
  if (is_shown_) draw("");
}

void Progress::reach(int done) {
  done_ = done;
  const auto now = Clock::now();
  if (is_for_program() && (now - drawn_ >= std::chrono::milliseconds(100) || done_ == count_)) {
    drawn_ = now;
    std::fputs(fmt::format("{}/{}\n", done_, count_).c_str(), stderr);
  }
  if (!is_shown_ || (now - drawn_ < std::chrono::milliseconds(100) && done_ < count_)) return;
  drawn_ = now;
  draw_bar(now);
}

void Progress::draw_bar(Clock::time_point now) const {
  const double elapsed = std::chrono::duration<double>(now - begin_).count();
  const double rate = elapsed > 0 ? done_ / elapsed : 0;
  std::string time;
  if (done_ > 0) {
    const double seconds_left = rate > 0 ? std::min((count_ - done_) / rate, 359'999.0) : 0;
    const long left = std::lround(seconds_left);
    time = fmt::format(", {:.1f} {}/s, {}:{:02} left", rate, unit_, left / 60, left % 60);
  }
  draw(fmt::format("{} {}{}{}", bar_of(done_, count_), unit_, time, note_));
}

WorkLine::WorkLine(bool is_quiet) : is_shown_(is_visible(is_quiet)) {}

void WorkLine::erase() {
  if (is_drawn_) draw("");
  is_drawn_ = false;
}

void WorkLine::tell(const std::string& line) {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  if (is_drawn_ && now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  is_drawn_ = true;
  draw(line);
}

std::function<void(const std::string&, int, int)> WorkLine::report() {
  if (!is_shown_) return {};
  return [this](const std::string& work, int done, int count) {
    tell(fmt::format("{} {}", bar_of(done, count), work));
  };
}

std::function<void(std::string_view, int, double)> WorkLine::report_of_rounds() {
  if (!is_shown_) return {};
  return [this](std::string_view surface, int round, double gap) {
    tell(fmt::format("looking for the cycle of \"{}\": round {}, gap {:.1e}", surface, round, gap));
  };
}

std::function<void(std::string_view, int, double)> round_line(bool is_quiet) {
  const auto line = std::make_shared<WorkLine>(is_quiet);
  auto report = line->report_of_rounds();
  if (!report) return {};
  return [line, report](std::string_view surface, int round, double gap) {
    report(surface, round, gap);
  };
}

}  // namespace pliant::cli
