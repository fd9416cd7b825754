// States that a run did not compute: read from a store, or restored from bytes.

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/stage_timer.hpp"
#include "pliant/simulation/frame_store.hpp"
#include "pliant/simulation/run.hpp"
#include "pliant/simulation/sealed_bytes.hpp"
#include "pliant/simulation/stored_state.hpp"

namespace pliant {
namespace {

constexpr std::string_view checkpoint_magic = "pliant checkpoint 1\n";

}  // namespace

const std::optional<Hash>& Simulation::Run::key(std::size_t index, int frame) {
  KeyChain& chain = keys_[index];
  const Surface& surface = scene_.surfaces[index];
  while (chain.length() <= frame - scene_.start) {
    const int last = scene_.start + chain.length() - 1;
    if (is_idle(surface, last)) {
      chain.append(nullptr, last);
      continue;
    }
    const SurfaceInputs inputs = sample_inputs(scene_, sampling_, index, last);
    chain.append(&inputs, last);
  }
  return chain.at(frame - scene_.start);
}

Hash Simulation::Run::sealing_key(std::size_t surface, int frame) {
  const std::optional<Hash>& known = key(surface, frame);
  return known ? *known : unnamed_key(keys_[surface].rest());
}

bool Simulation::Run::has_marks(std::size_t surface) const {
  return !bodies_[surface].state().unsettled.empty();
}

// Reads the result of a surface's step from the store, if it is there. An interrupted run ends
// here.
bool Simulation::Run::read_surface(std::size_t index, const Hash& key) {
  const StageTimer timer(profile_of(index), Stage::Checkpoints);
  Stepped& stepped = stepped_[index];
  if (should_stop_ && should_stop_()) {
    stepped.outcome = fail(ErrorCode::Interrupted, "interrupted");
    return true;
  }
  auto stored = read_stored(*store_, key, bodies_[index].rest(), has_marks(index));
  if (!stored || stored->facts.forces.size() != stepped.inputs.body.forces.size()) return false;
  bodies_[index].restore(std::move(stored->state));
  stepped.facts = std::move(stored->facts);
  stepped.is_read = true;
  stepped.outcome = {};
  return true;
}

// Writes the result of a surface's step to the store, unless it is faulty.
void Simulation::Run::write_surface(std::size_t index, const Hash& key) {
  const StageTimer timer(profile_of(index), Stage::Checkpoints);
  const Stepped& stepped = stepped_[index];
  if (!stepped.outcome || !stepped.inputs.faults->first().empty()) return;
  const Body& body = bodies_[index];
  store_->write(key, to_bytes(key, body.state(), stepped.facts, body.rest()));
}

// Advances to the latest frame up to `frame` for which the store has all states, if it is later
// than the present frame.
void Simulation::Run::read_latest(int frame) {
  for (int candidate = frame; candidate > frame_; --candidate) {
    auto states = stored_states(candidate);
    if (!states) continue;
    for (std::size_t k = 0; k < bodies_.size(); ++k) bodies_[k].restore(std::move((*states)[k]));
    frame_ = candidate;
    ++frame_counts_.read;
    keep(true);
    return;
  }
}

std::optional<std::vector<BodyState>> Simulation::Run::stored_states(int frame) {
  const auto is_rest = [&](std::size_t k) { return key(k, frame) == keys_[k].rest(); };
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!key(k, frame) || (!is_rest(k) && !store_->holds(*key(k, frame)))) return {};
  }
  std::vector<BodyState> states;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (is_rest(k)) {
      states.push_back(bodies_[k].rest_state());
      continue;
    }
    auto stored = read_stored(*store_, *key(k, frame), bodies_[k].rest(), has_marks(k));
    if (!stored) return {};
    states.push_back(std::move(stored->state));
  }
  return states;
}

Result<std::string> Simulation::Run::state_bytes(int frame) {
  if (auto reached = reach(frame); !reached) return fail(reached.error());
  std::string bytes(checkpoint_magic);
  append(bytes, static_cast<std::uint64_t>(std::int64_t{frame}));
  append(bytes, bodies_.size());
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const std::string state =
        to_bytes(sealing_key(k, frame), bodies_[k].state(), {}, bodies_[k].rest());
    append(bytes, state.size());
    bytes += state;
  }
  append_seal(bytes);
  return bytes;
}

Result<int> Simulation::Run::restore(std::string_view bytes) {
  const auto refuse = [](std::string message) {
    return fail(ErrorCode::InvalidInput, "cannot restore the state: " + std::move(message));
  };
  const auto held = unsealed(bytes, checkpoint_magic);
  if (!held) return refuse("it is not a saved state, or it is damaged");
  ByteReader reader(*held);
  const auto frame = static_cast<std::int64_t>(reader.number());
  const std::uint64_t count = reader.number();
  if (frame < scene_.start || frame > scene_.end) {
    return refuse(fmt::format("its frame {} is outside the scene's frames {} to {}", frame,
                              scene_.start, scene_.end));
  }
  if (count != bodies_.size()) {
    return refuse(fmt::format("it has {} surface{}, but the scene has {}", count,
                              count == 1 ? "" : "s", bodies_.size()));
  }
  std::vector<BodyState> states;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const std::string_view state = reader.take(reader.number());
    if (!reader.is_sound()) return refuse("it is damaged");
    const Hash of_scene = sealing_key(k, static_cast<int>(frame));
    auto stored = from_bytes(state, of_scene, bodies_[k].rest(), has_marks(k));
    if (!stored) {
      return refuse(fmt::format(
          "surface \"{}\", its channels or forces before frame {}, or the engine is not the same",
          scene_.surfaces[k].name, frame));
    }
    states.push_back(std::move(stored->state));
  }
  if (reader.left() != 0) return refuse("it is damaged");
  frame_ = static_cast<int>(frame);
  for (std::size_t k = 0; k < bodies_.size(); ++k) bodies_[k].restore(std::move(states[k]));
  keep(true);
  furthest_frame_ = std::max(furthest_frame_, frame_);
  return frame_;
}

}  // namespace pliant
