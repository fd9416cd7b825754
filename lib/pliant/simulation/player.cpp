#include "pliant/simulation/player.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/stage_timer.hpp"

namespace pliant {

Simulation::Player::Player(Scene scene, const SimulationOptions& options)
    : scene_(std::move(scene)),
      sampling_(scene_),
      bodies_(scene_, sampling_, options),
      first_(first_frame_of_run(scene_)),
      frame_(first_),
      furthest_frame_(first_),
      cache_(first_, options.checkpoint_bytes, &bodies_.memory()),
      states_(scene_, sampling_, options.store) {}

Result<void> Simulation::Player::make_bodies() {
  if (auto made = bodies_.make_all(); !made) return made;
  bodies_.add_to(states_);
  watch_ = bodies_.watch();
  return {};
}

// Advances to a frame of the range; back to the start if that fails.
Result<void> Simulation::Player::reach(int frame) {
  if (frame < scene_.start || frame > scene_.end) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("frame {} is outside the scene's frames {} to {}", frame, scene_.start,
                            scene_.end));
  }
  // On failure some bodies may have stepped and others not: rewind, so that the next call is valid.
  // Only custom forces throw.
  Result<void> reached;
  try {
    reached = go_to(frame);
  } catch (...) {
    rewind(first_);
    throw;
  }
  if (!reached) rewind(first_);
  return reached;
}

Result<Frame> Simulation::Player::at(int frame, Frame reuse) {
  if (auto reached = reach(frame); !reached) return fail(reached.error());
  return bodies_.output(frame, std::move(reuse));
}

Result<FrameReport> Simulation::Player::report(int frame, ReportDetail detail) {
  if (auto reached = reach(frame); !reached) return fail(reached.error());
  return bodies_.report(frame, detail);
}

Result<std::string> Simulation::Player::state_bytes(int frame) {
  if (auto reached = reach(frame); !reached) return fail(reached.error());
  return states_.checkpoint(frame, bodies_.all());
}

Result<int> Simulation::Player::restore(std::string_view state_bytes) {
  auto found = states_.read_checkpoint(state_bytes, bodies_.all());
  if (!found) return fail(found.error());
  frame_ = found->frame;
  for (std::size_t k = 0; k < bodies_.size(); ++k) watch_.forget_step(k);
  bodies_.restore(std::move(found->states));
  keep(true);
  furthest_frame_ = std::max(furthest_frame_, frame_);
  return frame_;
}

Result<void> Simulation::Player::go_to(int frame) {
  const std::optional<int> kept = cache_.latest_until(frame);
  if (frame < frame_ || kept > frame_) rewind(frame);
  // Frames not passed before are read one by one, for their warnings.
  if (states_.has_store() && frame <= furthest_frame_) read_latest(frame);
  while (frame_ < frame) {
    if (auto stepped = step(); !stepped) return stepped;
    passed_.add(frame_);
    ++frame_;
    keep(frame_ <= furthest_frame_);
    furthest_frame_ = std::max(furthest_frame_, frame_);
  }
  return {};
}

// After going back once, a request for a frame shortly before is likely.
void Simulation::Player::keep(bool is_going_back) {
  const bool is_wanted = is_going_back ? cache_.wants(frame_) : cache_.wants_checkpoint(frame_);
  if (!is_wanted) return;
  const StageTimer timer(bodies_.profile_of(0), Stage::Checkpoints);
  cache_.keep(frame_, bodies_.states());
}

// Advances from the output of frame_ to that of the next frame. What the surfaces say is processed
// in their order, since they may be solved in parallel. Kept frames give way to the next one.
Result<void> Simulation::Player::step() {
  bodies_.step(frame_, states_.has_store() ? &states_ : nullptr,
               [this] { return cache_.give_way(); });
  bool is_solved = false, is_read = false;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Surface& surface = scene_.surfaces[k];
    const bool is_early = frame_ < first_solved_frame(scene_, surface);
    if (surface.enabled && !surface.is_driven() && is_early && frame_ >= scene_.start)
      warnings_.expect(Warning::Kind::NeverStarts, surface.name, {}, frame_);
    if (!is_early) warnings_.happened(Warning::Kind::NeverStarts, surface.name, {});
    const Bodies::Step& step = bodies_.last_step(k);
    if (auto done = bodies_.outcome(k); !done) return done;
    is_read = is_read || step.is_read;
    if (!step.is_solved_now) continue;
    add_facts(warnings_, surface, frame_, step.inputs, step.facts);
    add_contacts(warnings_, scene_, surface, frame_, bodies_.all()[k]->state().contacts);
    bodies_.look(watch_, k, frame_, warnings_);
    is_solved = is_solved || (!step.is_read && !step.is_again);
  }
  frame_counts_.solved += is_solved ? 1 : 0;
  frame_counts_.read += is_read && !is_solved ? 1 : 0;
  return {};
}

// Goes back to a kept frame, or to the start, where all bodies are at rest.
void Simulation::Player::rewind(int frame) {
  for (std::size_t k = 0; k < bodies_.size(); ++k) watch_.forget_step(k);
  const std::optional<int> kept = cache_.latest_until(frame);
  if (kept) {
    bodies_.restore(cache_.use(*kept));
  } else {
    bodies_.reset();
  }
  frame_ = kept.value_or(first_);
}

// Advances to the latest frame up to `frame` for which the store has all states, if it is later
// than the present frame.
void Simulation::Player::read_latest(int frame) {
  for (int candidate = frame; candidate > frame_; --candidate) {
    auto found = states_.states_at(candidate, bodies_.all());
    if (!found) continue;
    bodies_.restore(std::move(found->states));
    for (std::size_t k = 0; k < bodies_.size(); ++k) watch_.forget_step(k);
    frame_ = candidate;
    ++frame_counts_.read;
    keep(true);
    return;
  }
}

std::vector<Warning> Simulation::Player::warnings() const {
  const auto& ranges = passed_.ranges();
  const bool is_complete =
      first_ == scene_.end || (ranges.size() == 1 && ranges.front().first == first_ &&
                               ranges.front().second == scene_.end - 1);
  std::vector<Warning> warnings = warnings_about(bodies_.rest_shapes(), scene_);
  for (Warning& warning : warnings_.warnings(scene_, is_complete)) {
    warnings.push_back(std::move(warning));
  }
  drop_repeated(warnings);
  if (is_complete) {
    std::vector<bool> has_moved;
    for (std::size_t k = 0; k < bodies_.size(); ++k) has_moved.push_back(watch_.has_moved(k));
    add_still_surfaces(warnings, scene_, has_moved);
  }
  return warnings;
}

}  // namespace pliant
