#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/core/hash.hpp"
#include "pliant/core/result.hpp"
#include "pliant/sampling/sampling.hpp"
#include "pliant/states/state_key.hpp"
#include "pliant/states/state_store.hpp"
#include "pliant/states/stored_state.hpp"

namespace pliant {

/// The states of all surfaces at a frame.
struct FrameStates {
  int frame = 0;
  std::vector<BodyState> states;  ///< in the order of the scene
};

/// The states of a scene's surfaces beyond one run: in a store, each under its key, and as the
/// bytes of a checkpoint. `bodies` are those of all surfaces, in the order of the scene. Not for
/// programs.
class SceneStates {
 public:
  /// Requires: scene and sampling outlive it. `store` null: there are checkpoints only.
  SceneStates(const Scene& scene, const SceneSampling& sampling, StateStore* store)
      : scene_(scene), first_(first_frame_of_run(scene)), sampling_(sampling), store_(store) {}

  /// Adds the next surface, by the key of its body at rest.
  void add(const Hash& rest_key) {
    keys_.emplace_back(rest_key);
    cycles_.emplace_back();
  }

  bool has_store() const { return store_ != nullptr; }

  /// The result of a step at `frame` with these inputs, if the store has it. Requires: the earlier
  /// frames were asked for, or `states_at` was.
  std::optional<StoredState> read(std::size_t surface, int frame, const SurfaceInputs& inputs,
                                  const Body& body);

  /// Writes the result of the same step, which the body is in after it.
  void write(std::size_t surface, int frame, const Body& body, const StepFacts& facts);

  /// The state at the beginning of a surface's cycle, if the store has it; and to write it.
  std::optional<BodyState> cycle(std::size_t surface, const Body& body);
  void write_cycle(std::size_t surface, const Body& body);

  /// The states of all surfaces at a frame; null if the store lacks any of them.
  std::optional<FrameStates> states_at(int frame, std::span<const std::unique_ptr<Body>> bodies);

  /// The present states as the bytes of a checkpoint at `frame`.
  std::string checkpoint(int frame, std::span<const std::unique_ptr<Body>> bodies);

  /// The states of a checkpoint. Errors: InvalidInput if the bytes are damaged, or not of this
  /// scene, at that frame, under this engine and solver.
  Result<FrameStates> read_checkpoint(std::string_view bytes,
                                      std::span<const std::unique_ptr<Body>> bodies);

 private:
  const std::optional<Hash>& key(std::size_t surface, int frame);
  const std::optional<Hash>& key_in_cycle(std::size_t surface, int frame);
  void append_to(KeyChain& chain, std::size_t surface, int frame) const;
  bool knows(const std::vector<ContactFacts>& contacts) const;
  std::optional<StoredState> stored(const Hash& key, const Body& body) const;
  Hash sealing_key(std::size_t surface, int frame);

  const Scene& scene_;
  int first_;  // the run's first frame, where all surfaces are at rest
  const SceneSampling& sampling_;
  StateStore* store_;
  std::vector<KeyChain> keys_;                   // one a surface
  std::vector<std::optional<KeyChain>> cycles_;  // those with a loop, from its beginning on
};

}  // namespace pliant
