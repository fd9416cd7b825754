#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/shelf.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/sampling/sampling.hpp"
#include "pliant/simulation/animation_bake.hpp"
#include "pliant/simulation/simulation.hpp"
#include "pliant/sweep/sweep.hpp"

namespace pliant {
namespace {

// Of the memory, what takes share may use this.
std::size_t shelf_part(std::size_t max_memory) { return max_memory / 8; }

// What each of so many takes at once may use; 0 takes: one, with all of it.
std::size_t share_of(std::size_t count, std::size_t max_memory) {
  return count == 0 ? max_memory : (max_memory - shelf_part(max_memory)) / count;
}

Result<Measures> play(Simulation& simulation, const FrameSpan& frames, const TakeRun& options,
                      const Scene& scene) {
  PLIANT_EXPECTS(options.file.empty() || !options.watch);
  std::optional<AnimationBake> bake;
  if (!options.file.empty()) {
    auto made = AnimationBake::make(
        simulation, {.file = options.file, .frames = frames, .max_memory = options.max_memory});
    if (!made) return fail(made.error());
    bake.emplace(*std::move(made));
    if (auto begun = bake->begin(); !begun) return fail(begun.error());
  }
  Measurer measurer(simulation);
  Frame frame;
  for (int number = simulation.scene().start; number <= frames.last; ++number) {
    if (options.should_stop && options.should_stop()) return interrupted();
    auto reached = simulation.at(number, std::move(frame));
    if (!reached) return fail(reached.error());
    frame = *std::move(reached);
    if (number < frames.first) continue;
    measurer.add(frame);
    if (options.watch) {
      const auto goes_on = options.watch(simulation, frame);
      if (!goes_on) return fail(goes_on.error());
      if (!*goes_on) break;
    }
    if (!bake) continue;
    if (auto written = bake->write(frame); !written) return fail(written.error());
  }
  auto measures = measurer.measures();
  if (!measures) return measures;
  if (options.check) {
    if (auto same = options.check(scene); !same) return fail(same.error());
  }
  if (bake) {
    if (auto finished = bake->finish(); !finished) return fail(finished.error());
  }
  return measures;
}

// Hands out takes to threads, as many at once as the memory holds.
class Turns {
 public:
  struct Turn {
    std::size_t take = 0;
    std::size_t memory = 0;  // [bytes]
    std::size_t level = 0;   // takes at once for which the memory is divided; 0: all of it
    int threads = 1;
    Shelf* shelf = nullptr;
  };

  Turns(std::span<const std::size_t> takes, const SweepRun& options)
      : takes_(takes),
        options_(options),
        level_(takes_at_once(takes.size(), options.threads, options.max_memory).count),
        shelf_(std::in_place, memory_of_shelf()) {}

  std::size_t at_once() const { return level_; }

  // The next take, once there is memory for it; null: there is none.
  std::optional<Turn> next() {
    std::unique_lock lock(mutex_);
    for (;;) {
      if (is_ended_) return {};
      const bool is_first_time = next_ < takes_.size();
      const bool is_left = is_first_time || !again_.empty();
      if (!is_first_time && is_left) level_ = std::min(level_, again_.front().level);
      if (!is_left && running_ == 0) {
        changed_.notify_all();
        return {};
      }
      // Alone with all of it, the shelf's part too, which another take may be using.
      const bool may_begin = level_ > 0 || running_ == 0;
      if (is_left && may_begin && memory_used_ + share() <= options_.max_memory - memory_of_shelf())
        break;
      changed_.wait(lock);
    }
    Turn turn{.memory = share(), .level = level_};
    if (next_ < takes_.size()) {
      turn.take = takes_[next_++];
    } else {
      turn.take = again_.front().take;
      again_.pop_front();
    }
    if (level_ == 0) shelf_.reset();
    turn.shelf = shelf_ ? &*shelf_ : nullptr;
    turn.threads =
        std::max(1, options_.threads / static_cast<int>(std::max<std::size_t>(1, level_)));
    memory_used_ += turn.memory;
    ++running_;
    return turn;
  }

  // A take ended, and is reported, or begins again with more memory.
  void end(const Turn& turn, const TakeOutcome& outcome) {
    const std::lock_guard lock(mutex_);
    memory_used_ -= turn.memory;
    --running_;
    changed_.notify_all();
    const bool has_failed = !outcome.measures;
    if (has_failed && outcome.measures.error().code == ErrorCode::Interrupted) {
      is_ended_ = true;
      return;
    }
    if (has_failed && outcome.measures.error().code == ErrorCode::OutOfMemory && turn.level > 0) {
      again_.push_back({turn.take, turn.level / 2});
      if (turn.level == level_ && ++short_count_ > done_count_) {
        level_ /= 2;
        short_count_ = done_count_ = 0;
      }
      return;
    }
    ++done_count_;
    if (is_ended_ || !options_.take_done) return;
    if (auto told = options_.take_done(outcome); !told) {
      error_ = std::move(told);
      is_ended_ = true;
    }
  }

  // A thread leaves by an exception: all others end too.
  void abandon() {
    const std::lock_guard lock(mutex_);
    is_ended_ = true;
    changed_.notify_all();
  }

  bool is_ended() {
    const std::lock_guard lock(mutex_);
    return is_ended_;
  }

  Result<void> result() {
    if (!error_) return error_;
    if (is_ended_) return interrupted();
    return {};
  }

 private:
  std::size_t memory_of_shelf() const { return level_ == 0 ? 0 : shelf_part(options_.max_memory); }
  std::size_t share() const { return share_of(level_, options_.max_memory); }

  std::span<const std::size_t> takes_;
  const SweepRun& options_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t next_ = 0;
  struct Again {
    std::size_t take = 0;
    std::size_t level = 0;  // at most
  };
  std::deque<Again> again_;  // takes that lacked memory, after all others
  std::size_t level_;
  std::size_t short_count_ = 0,
              done_count_ = 0;  // of takes at this level that lacked memory or not
  std::size_t memory_used_ = 0;
  std::size_t running_ = 0;
  bool is_ended_ = false;
  Result<void> error_;
  std::optional<Shelf> shelf_;
};

}  // namespace

TakesAtOnce takes_at_once(std::size_t takes, int threads, std::size_t max_memory) {
  const auto count = std::min(static_cast<std::size_t>(threads), std::max<std::size_t>(1, takes));
  return {count, share_of(count, max_memory)};
}

std::size_t memory_of_takes(std::size_t count, std::size_t each) {
  const std::size_t of_takes = count * each;
  return of_takes + (of_takes + 6) / 7;  // shelf_part is an eighth of the whole
}

TakeOutcome Sweep::run(std::size_t take, const TakeRun& options) const {
  const auto begin = std::chrono::steady_clock::now();
  TakeOutcome outcome{.take = take, .measures = Measures()};
  const auto run_it = [&]() -> Result<Measures> {
    auto scene = scene_of(take);
    if (!scene) return fail(scene.error());
    if (options.check) {
      if (auto same = options.check(*scene); !same) return fail(same.error());
    }
    const auto frames = frames_of(*scene);
    if (!frames) return fail(frames.error());
    auto simulation = Simulation::make(*scene, {.checkpoint_bytes = 0,
                                                .max_memory = options.max_memory,
                                                .threads = options.threads,
                                                .solver = settings_.solver,
                                                .should_stop = options.should_stop,
                                                .shelf = options.shelf});
    if (!simulation) return fail(simulation.error());
    outcome.memory = simulation->surface_memory();
    return play(*simulation, *frames, options, *scene);
  };
  try {
    outcome.measures = run_it();
  } catch (const std::bad_alloc&) {
    outcome.measures = fail(ErrorCode::OutOfMemory, "the machine has no more memory");
  }
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return outcome;
}

Result<void> Sweep::run(std::span<const std::size_t> takes, const SweepRun& options) const {
  PLIANT_EXPECTS(options.threads >= 1);
  if (takes.empty()) return {};
  Turns turns(takes, options);
  const auto should_stop = [&] {
    return (options.should_stop && options.should_stop()) || turns.is_ended();
  };
  const std::size_t workers = turns.at_once();
  ThreadPool threads(static_cast<int>(workers));
  threads.for_each(workers, [&](std::size_t) {
    while (const auto turn = turns.next()) {
      try {
        TakeRun run{.max_memory = turn->memory,
                    .threads = turn->threads,
                    .should_stop = should_stop,
                    .shelf = turn->shelf,
                    .file = options.file_of ? options.file_of(turn->take) : std::string(),
                    .check = options.check};
        if (options.watch) {
          run.watch = [&, take = turn->take](const Simulation& simulation, const Frame& frame) {
            return options.watch(take, simulation, frame);
          };
        }
        turns.end(*turn, this->run(turn->take, run));
      } catch (...) {  // of a force or a callback of the program
        turns.abandon();
        throw;
      }
    }
  });
  return turns.result();
}

}  // namespace pliant
