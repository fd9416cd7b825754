#include "pliant/states/scene_states.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "pliant/states/sealed_bytes.hpp"

namespace pliant {
namespace {

constexpr std::string_view checkpoint_magic = "pliant checkpoint 1\n";

}  // namespace

// Appends the key after the step at a frame.
void SceneStates::append_to(KeyChain& chain, std::size_t surface, int frame) const {
  if (!is_solved_at(scene_, scene_.surfaces[surface], frame)) return chain.append(nullptr, frame);
  const SurfaceInputs inputs = sample_inputs(scene_, sampling_, surface, frame);
  chain.append(&inputs, frame);
}

const std::optional<Hash>& SceneStates::key(std::size_t surface, int frame) {
  KeyChain& chain = keys_[surface];
  const Surface& of = scene_.surfaces[surface];
  const int start = first_solved_frame(scene_, of);
  if (frame >= start && begins_cycle(scene_, of, start)) {
    return key_in_cycle(surface, solved_frame(scene_, of, frame) - start);
  }
  while (chain.length() <= frame - first_) append_to(chain, surface, first_ + chain.length() - 1);
  return chain.at(frame - first_);
}

// `frame`: counted from the beginning of the first cycle, and less than its length.
const std::optional<Hash>& SceneStates::key_in_cycle(std::size_t surface, int frame) {
  const Surface& of = scene_.surfaces[surface];
  const int start = first_solved_frame(scene_, of), length = of.solver.loop.value();
  std::optional<KeyChain>& cycle = cycles_[surface];
  if (!cycle) {
    // The state at the beginning depends on what a round does.
    KeyChain round(keys_[surface].rest());
    while (round.length() <= length) append_to(round, surface, start + round.length() - 1);
    cycle.emplace(cycle_key(round.at(length), 1 / scene_.fps));
  }
  while (cycle->length() <= frame) append_to(*cycle, surface, start + cycle->length() - 1);
  return cycle->at(frame);
}

Hash SceneStates::sealing_key(std::size_t surface, int frame) {
  const std::optional<Hash>& known = key(surface, frame);
  return known ? *known : unnamed_key(keys_[surface].rest());
}

// Whether facts are about colliders of the scene.
bool SceneStates::knows(const std::vector<ContactFacts>& contacts) const {
  const auto is_known = [&](int collider) {
    return static_cast<std::size_t>(collider) < scene_.colliders.size();
  };
  return std::ranges::all_of(contacts, [&](const ContactFacts& facts) {
    return is_known(facts.collider) && std::ranges::all_of(facts.squeezed, is_known);
  });
}

std::optional<StoredState> SceneStates::stored(const Hash& key, const Body& body) const {
  auto stored = read_stored(*store_, key, body.rest(), layout_of(body.state()));
  if (stored && !knows(stored->state.contacts)) return {};
  return stored;
}

std::optional<StoredState> SceneStates::read(std::size_t surface, int frame,
                                             const SurfaceInputs& inputs, const Body& body) {
  KeyChain& keys = keys_[surface];
  const bool has_loop = scene_.surfaces[surface].solver.loop.has_value();
  if (!has_loop && keys.length() == frame + 1 - first_) keys.append(&inputs, frame);
  const std::optional<Hash>& after = key(surface, frame + 1);
  if (!after) return {};
  auto stored = this->stored(*after, body);
  if (stored && stored->facts.forces.size() != inputs.body.forces.size()) return {};
  return stored;
}

void SceneStates::write(std::size_t surface, int frame, const Body& body, const StepFacts& facts) {
  const std::optional<Hash>& after = key(surface, frame + 1);
  if (after) store_->write(*after, to_bytes(*after, body.state(), facts, body.rest()));
}

std::optional<BodyState> SceneStates::cycle(std::size_t surface, const Body& body) {
  const std::optional<Hash>& key = key_in_cycle(surface, 0);
  if (!store_ || !key) return {};
  auto stored = this->stored(*key, body);
  if (!stored) return {};
  return std::move(stored->state);
}

void SceneStates::write_cycle(std::size_t surface, const Body& body) {
  const std::optional<Hash>& key = key_in_cycle(surface, 0);
  if (store_ && key) store_->write(*key, to_bytes(*key, body.state(), {}, body.rest()));
}

std::optional<FrameStates> SceneStates::states_at(int frame,
                                                  std::span<const std::unique_ptr<Body>> bodies) {
  const auto is_rest = [&](std::size_t k) { return key(k, frame) == keys_[k].rest(); };
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    if (!key(k, frame) || (!is_rest(k) && !store_->holds(*key(k, frame)))) return {};
  }
  FrameStates found{frame, {}};
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    if (is_rest(k)) {
      found.states.push_back(bodies[k]->rest_state());
      continue;
    }
    auto stored = this->stored(*key(k, frame), *bodies[k]);
    if (!stored) return {};
    found.states.push_back(std::move(stored->state));
  }
  return found;
}

std::string SceneStates::checkpoint(int frame, std::span<const std::unique_ptr<Body>> bodies) {
  std::string bytes(checkpoint_magic);
  append(bytes, static_cast<std::uint64_t>(std::int64_t{frame}));
  append(bytes, bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const std::string state =
        to_bytes(sealing_key(k, frame), bodies[k]->state(), {}, bodies[k]->rest());
    append(bytes, state.size());
    bytes += state;
  }
  append_seal(bytes);
  return bytes;
}

Result<FrameStates> SceneStates::read_checkpoint(std::string_view bytes,
                                                 std::span<const std::unique_ptr<Body>> bodies) {
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
  if (count != bodies.size()) {
    return refuse(fmt::format("it has {} surface{}, but the scene has {}", count,
                              count == 1 ? "" : "s", bodies.size()));
  }
  FrameStates found{static_cast<int>(frame), {}};
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const std::string_view state = reader.take(reader.number());
    if (!reader.is_sound()) return refuse("it is damaged");
    const Hash of_scene = sealing_key(k, found.frame);
    auto stored = from_bytes(state, of_scene, bodies[k]->rest(), layout_of(bodies[k]->state()));
    if (!stored || !knows(stored->state.contacts)) {
      return refuse(fmt::format(
          "surface \"{}\", its channels or forces before frame {}, or the engine is not the same",
          scene_.surfaces[k].name, frame));
    }
    found.states.push_back(std::move(stored->state));
  }
  if (reader.left() != 0) return refuse("it is damaged");
  return found;
}

}  // namespace pliant
