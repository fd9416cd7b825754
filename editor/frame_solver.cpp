#include "editor/frame_solver.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "pliant/core/byte_order.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant::editor {
namespace {

using namespace std::chrono_literals;

constexpr auto rest = 200ms;          // from the last change to the frames that nobody asked for
constexpr auto between_news = 50ms;   // of frames that are solved
constexpr auto between_turns = 20ms;  // while another one goes first

std::shared_ptr<const std::string> shared(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}

// Of the memory, for each of states, shapes and frames; the rest is for the simulation.
std::size_t part_of(std::size_t memory) {
  constexpr std::size_t most = 500'000'000;
  return std::min(memory / 8, most);
}

// We throw nothing ourselves: what is thrown here tells of a lack of memory.
template <class Work>
auto attempt(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::exception& error) {
    return fail(ErrorCode::OutOfMemory,
                fmt::format("the memory of the machine does not suffice: {}", error.what()));
  }
}

}  // namespace

FrameSolver::FrameSolver(Options options)
    : options_(std::move(options)),
      own_caches_(options_.leader
                      ? nullptr
                      : std::make_unique<Caches>(part_of(options_.simulation.max_memory))),
      caches_(options_.leader ? options_.leader->caches_ : *own_caches_),
      frame_part_(part_of(options_.simulation.max_memory)) {
  SimulationOptions& run = options_.simulation;
  run.max_memory -= (options_.leader ? 1 : 3) * frame_part_;
  run.store = &caches_.store;
  run.shelf = &caches_.shelf;
  thread_ = std::thread([this] { this->run(); });
}

FrameSolver::~FrameSolver() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void FrameSolver::take(Revision revision, Scene scene) {
  std::list<Waiting> outdated;
  {
    const std::lock_guard lock(mutex_);
    first_ = scene.start;
    solved_.assign(FrameSpan{scene.start, scene.end}.count(), false);
    newest_ = Newest{revision, std::move(scene)};
    revision_ = revision;
    taken_ = Clock::now();
    reached_for_ = std::numeric_limits<int>::min();
    frames_.clear();
    frame_bytes_ = 0;
    failure_.reset();
    outdated = std::exchange(waiting_, {});
  }
  changed_.notify_all();
  for (const Waiting& one : outdated) one.reply({});
}

void FrameSolver::refuse(Revision revision, Error error) {
  std::list<Waiting> outdated;
  {
    const std::lock_guard lock(mutex_);
    newest_.reset();
    revision_ = revision;
    frames_.clear();
    frame_bytes_ = 0;
    solved_.clear();
    failure_ = Failure{std::move(error), {}};
    outdated = std::exchange(waiting_, {});
  }
  changed_.notify_all();
  for (const Waiting& one : outdated) one.reply({});
  options_.notify();
}

void FrameSolver::ask(const FrameQuestion& question, std::function<void(FrameAnswer)> reply) {
  FrameAnswer known;
  {
    const std::lock_guard lock(mutex_);
    if (question.revision == revision_ && revision_ != 0) {
      const bool is_frame = question.kind == FrameQuestion::Kind::Frame;
      if (is_frame) wanted_ = question.frame;
      const auto found = is_frame ? frames_.find(question.frame) : frames_.end();
      if (found != frames_.end()) {
        known = found->second;
      } else if (fails(question)) {
        known = fail(failure_->error);
      } else {
        waiting_.push_back({question, std::move(reply), ++asked_});
        changed_.notify_all();
        return;
      }
    }
  }
  reply(std::move(known));
}

std::shared_ptr<const std::string> FrameSolver::shape(const std::string& key) const {
  return page_.shape(key);
}

ReadyFrames FrameSolver::ready() const {
  const std::lock_guard lock(mutex_);
  ReadyFrames ready{revision_, {}};
  for (std::size_t k = 0; k < solved_.size(); ++k) {
    if (!solved_[k]) continue;
    const int frame = first_ + static_cast<int>(k);
    if (ready.ranges.empty() || ready.ranges.back().second != frame - 1)
      ready.ranges.emplace_back(frame, frame);
    ready.ranges.back().second = frame;
  }
  return ready;
}

Revision FrameSolver::revision() const {
  const std::lock_guard lock(mutex_);
  return revision_;
}

std::optional<Error> FrameSolver::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_ ? std::optional(failure_->error) : std::nullopt;
}

// Requires: the lock. What a scene draws fails only with all else.
bool FrameSolver::fails(const FrameQuestion& question) const {
  if (!failure_ || !failure_->from) return failure_.has_value();
  return question.kind != FrameQuestion::Kind::Scene && question.frame >= *failure_->from;
}

bool FrameSolver::is_outdated(Revision revision) const {
  const std::lock_guard lock(mutex_);
  return is_ending_ || revision_ != revision;
}

// Whether somebody waits for an answer, or is likely to ask in a moment.
bool FrameSolver::is_wanted() const {
  const std::lock_guard lock(mutex_);
  return is_answering_ || !waiting_.empty() || Clock::now() < taken_ + rest;
}

// Also for a question that came later and needs less, and for who goes first. What was solved
// meanwhile is kept.
bool FrameSolver::should_stop(Revision revision) const {
  if (options_.leader && options_.leader->is_wanted()) return true;
  const std::lock_guard lock(mutex_);
  return is_ending_ || revision_ != revision ||
         std::ranges::any_of(waiting_, [&](const Waiting& one) {
           return one.question.kind == FrameQuestion::Kind::Frame && one.number > reason_ &&
                  one.question.frame < reached_for_;
         });
}

void FrameSolver::run() {
  for (;;) {
    std::optional<Newest> newest;
    {
      Lock lock(mutex_);
      changed_.wait(lock, [&] { return is_ending_ || newest_; });
      if (is_ending_) return;
      newest = std::exchange(newest_, std::nullopt);
    }
    const auto played = attempt([&] { return play(*newest); });
    if (played) continue;
    (void)attempt([&]() -> Result<void> {
      fail_from({}, newest->revision, played.error());
      return {};
    });
  }
}

// Until there is a newer revision. Errors: nothing of this one can be played.
Result<void> FrameSolver::play(const Newest& newest) {
  const Revision revision = newest.revision;
  SimulationOptions options = options_.simulation;
  bool is_made = false;
  options.should_stop = [&] { return is_made ? should_stop(revision) : is_outdated(revision); };
  auto simulation = Simulation::make(newest.scene, options);
  if (!simulation) return fail(simulation.error());
  is_made = true;
  while (auto waiting = next(revision)) {
    const FrameQuestion& question = waiting->question;
    auto answered = attempt([&] { return answer(*simulation, question, options.should_stop); });
    if (!answered && answered.error().code == ErrorCode::Interrupted && put_back(*waiting))
      continue;
    if (is_outdated(revision)) {
      waiting->reply({});
    } else if (answered) {
      waiting->reply(*std::move(answered));
    } else {
      if (question.kind == FrameQuestion::Kind::Frame)
        fail_from(question.frame, revision, answered.error());
      waiting->reply(fail(answered.error()));
    }
  }
  return {};
}

// What is asked, frames first, since somebody looks at them, and of these the one asked for last;
// after a rest a frame that nobody asked for. Null: the revision is out of date.
std::optional<FrameSolver::Waiting> FrameSolver::next(Revision revision) {
  Lock lock(mutex_);
  is_answering_ = false;
  const auto is_over = [&] { return is_ending_ || revision_ != revision; };
  const auto has_work = [&] { return is_over() || !waiting_.empty(); };
  if (!changed_.wait_until(lock, taken_ + rest, has_work) && !next_unsolved())
    changed_.wait(lock, has_work);
  while (options_.leader && !is_over() && options_.leader->is_wanted())
    changed_.wait_for(lock, between_turns);
  if (is_over()) return {};
  std::optional<Waiting> found;
  if (waiting_.empty()) {
    found = Waiting{{.revision = revision, .frame = *next_unsolved()}, [](const FrameAnswer&) {}};
  } else {
    const auto first = std::ranges::min_element(
        waiting_, {}, [](const Waiting& one) { return std::pair(one.question.kind, -one.number); });
    found = std::move(*first);
    waiting_.erase(first);
  }
  const bool is_scene = found->question.kind == FrameQuestion::Kind::Scene;
  reached_for_ = is_scene ? std::numeric_limits<int>::min() : found->question.frame;
  reason_ = found->question.kind == FrameQuestion::Kind::Frame ? found->number : 0;
  is_answering_ = found->number != 0;
  return found;
}

// Whether a question that gave way waits again; not if it is out of date.
bool FrameSolver::put_back(const Waiting& waiting) {
  const std::lock_guard lock(mutex_);
  if (is_ending_ || waiting.question.revision != revision_) return false;
  if (waiting.number != 0) waiting_.push_back(waiting);
  return true;
}

// Requires: the lock. The first frame from the playhead on that is not solved, then those before.
std::optional<int> FrameSolver::next_unsolved() const {
  const auto count = static_cast<int>(solved_.size());
  const int from = std::clamp(wanted_, first_, first_ + count - 1) - first_;
  for (int k = 0; k < count; ++k) {
    const int index = (from + k) % count;
    if (!solved_[static_cast<std::size_t>(index)] && !fails({.frame = first_ + index}))
      return first_ + index;
  }
  return {};
}

Result<std::shared_ptr<const std::string>> FrameSolver::answer(Simulation& simulation,
                                                               const FrameQuestion& question,
                                                               const StopRequest& should_stop) {
  switch (question.kind) {
    case FrameQuestion::Kind::Frame:
      return frame(simulation, question.revision, question.frame);
    case FrameQuestion::Kind::Scene: {
      auto scene = page_.scene(question.revision, simulation, should_stop);
      if (!scene) return fail(scene.error());
      return shared(*std::move(scene));
    }
    case FrameQuestion::Kind::Details: {
      auto details = page_.details(simulation, question.frame);
      if (!details) return fail(details.error());
      return shared(*std::move(details));
    }
  }
  return fail(ErrorCode::InvalidInput, "unknown question");
}

Result<std::shared_ptr<const std::string>> FrameSolver::frame(Simulation& simulation,
                                                              Revision revision, int number) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = frames_.find(number);
    if (revision == revision_ && found != frames_.end()) return found->second;
  }
  auto at = simulation.at(number, std::move(reused_));
  if (!at) return fail(at.error());
  reused_ = *std::move(at);
  auto bytes = positions_bytes(reused_);
  if (!bytes) return fail(bytes.error());
  auto kept = shared(*std::move(bytes));
  keep(revision, number, kept);
  return kept;
}

void FrameSolver::keep(Revision revision, int number, std::shared_ptr<const std::string> bytes) {
  bool is_all = false;
  {
    const std::lock_guard lock(mutex_);
    if (revision != revision_) return;
    solved_[static_cast<std::size_t>(number - first_)] = true;
    is_all = std::ranges::find(solved_, false) == solved_.end();
    frame_bytes_ += bytes->size();
    frames_[number] = std::move(bytes);
    drop_frames();
  }
  tell(is_all);
}

// Requires: the lock. Those farthest from the playhead give way; they are read from the store if
// they are asked for.
void FrameSolver::drop_frames() {
  const std::size_t most = frame_part_ - (is_lent_ ? lendable() : 0);
  while (frame_bytes_ > most && frames_.size() > 1) {
    const auto is_nearer = [&](int a, int b) {
      return std::abs(a - wanted_) < std::abs(b - wanted_);
    };
    const auto low = frames_.begin(), high = std::prev(frames_.end());
    const auto farthest = is_nearer(low->first, high->first) ? high : low;
    frame_bytes_ -= farthest->second->size();
    frames_.erase(farthest);
  }
}

void FrameSolver::lend(bool is_lent) {
  const std::lock_guard lock(mutex_);
  is_lent_ = is_lent;
  drop_frames();
}

// The frame fails, and all behind it; null: everything.
void FrameSolver::fail_from(std::optional<int> frame, Revision revision, const Error& error) {
  std::list<Waiting> failed;
  {
    const std::lock_guard lock(mutex_);
    if (is_ending_ || revision != revision_) return;
    failure_ = Failure{error, frame};
    for (auto one = waiting_.begin(); one != waiting_.end();) {
      const auto here = one++;
      if (fails(here->question)) failed.splice(failed.end(), waiting_, here);
    }
  }
  for (const Waiting& one : failed) one.reply(fail(error));
  tell(true);
}

void FrameSolver::tell(bool at_once) {
  const auto now = Clock::now();
  if (!at_once && now - told_ < between_news) return;
  told_ = now;
  options_.notify();
}

}  // namespace pliant::editor
