#include "pliant/states/kept_states.hpp"

#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "pliant/states/sealed_bytes.hpp"

namespace pliant {
namespace {

constexpr std::string_view checkpoint_magic = "pliant checkpoint 1\n";

bool has_marks(const Body& body) { return !body.state().unsettled.empty(); }

}  // namespace

const std::optional<Hash>& KeptStates::key(std::size_t surface, int frame) {
  KeyChain& chain = keys_[surface];
  while (chain.length() <= frame - scene_.start) {
    const int last = scene_.start + chain.length() - 1;
    if (!is_solved_at(scene_, scene_.surfaces[surface], last)) {
      chain.append(nullptr, last);
      continue;
    }
    const SurfaceInputs inputs = sample_inputs(scene_, sampling_, surface, last);
    chain.append(&inputs, last);
  }
  return chain.at(frame - scene_.start);
}

Hash KeptStates::sealing_key(std::size_t surface, int frame) {
  const std::optional<Hash>& known = key(surface, frame);
  return known ? *known : unnamed_key(keys_[surface].rest());
}

std::optional<StoredState> KeptStates::read(std::size_t surface, int frame,
                                            const SurfaceInputs& inputs, const Body& body) {
  KeyChain& keys = keys_[surface];
  if (keys.length() == frame + 1 - scene_.start) keys.append(&inputs, frame);
  const std::optional<Hash>& after = key(surface, frame + 1);
  if (!after) return {};
  auto stored = read_stored(*store_, *after, body.rest(), has_marks(body));
  if (stored && stored->facts.forces.size() != inputs.body.forces.size()) return {};
  return stored;
}

void KeptStates::write(std::size_t surface, int frame, const Body& body, const StepFacts& facts) {
  const std::optional<Hash>& after = key(surface, frame + 1);
  if (after) store_->write(*after, to_bytes(*after, body.state(), facts, body.rest()));
}

std::optional<FrameStates> KeptStates::states_at(int frame,
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
    auto stored = read_stored(*store_, *key(k, frame), bodies[k]->rest(), has_marks(*bodies[k]));
    if (!stored) return {};
    found.states.push_back(std::move(stored->state));
  }
  return found;
}

std::string KeptStates::checkpoint(int frame, std::span<const std::unique_ptr<Body>> bodies) {
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

Result<FrameStates> KeptStates::read_checkpoint(std::string_view bytes,
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
    auto stored = from_bytes(state, of_scene, bodies[k]->rest(), has_marks(*bodies[k]));
    if (!stored) {
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
