#include "cli/sweep/sweep_wait.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "cli/terminal/interrupt.hpp"

namespace pliant::cli {

WaitingBar::WaitingBar(const std::string& folder, std::vector<bool> takes, std::size_t count,
                       bool is_quiet)
    : progress_(static_cast<int>(count), is_quiet, "takes") {
  if (count == 0 || !progress_.is_shown()) return;
  if (auto watch = SweepWatch::begin(folder, std::move(takes), &was_interrupted))
    watch_.emplace(*std::move(watch));
}

void WaitingBar::look(bool is_running) {
  using namespace std::chrono_literals;
  constexpr int share = 20;  // of the time, spent looking
  const auto begin = Clock::now();
  if (!watch_ || begin < next_) return;
  // What cannot be read now may be at the next look.
  (void)watch_->look(&was_interrupted);
  if ((is_running || watch_->ended() > 0) && !has_begun_) {
    has_begun_ = true;
    progress_.begin_again();
  }
  const std::size_t failed = watch_->failed();
  progress_.add_note(!has_begun_ ? ", queued"
                                 : (failed > 0 ? fmt::format(", {} failed", failed) : ""));
  progress_.reach(static_cast<int>(watch_->ended()));
  const auto end = Clock::now();
  next_ = end + std::max<Clock::duration>(1s, share * (end - begin));
}

}  // namespace pliant::cli
