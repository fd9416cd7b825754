#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pliant/body/settings.hpp"
#include "pliant/core/hash.hpp"
#include "pliant/plate/solver_choice.hpp"

namespace pliant {

struct RestShape;
struct SurfaceInputs;

// Keys for states, computed from everything that determines a state. Not for programs.

/// The key of a surface at rest under this engine: from its nodes at rest and how they are
/// joined, the settings of its body and the solver. An engine whose sources differ in any byte
/// gives other keys.
Hash rest_key(const RestShape& shape, const BodySettings& settings, SolverChoice solver);

/// The key of a state of a surface that has no key of its own; see `next_key`.
Hash unnamed_key(const Hash& rest);

/// The key of the state after a step at `frame` with these inputs from the state with key `before`.
/// Null if a custom force without a key acts: the results of its functions are unknown.
std::optional<Hash> next_key(const Hash& before, const SurfaceInputs& inputs, int frame);

/// The key of the state at the beginning of a cycle: `round` is the key of the state after one
/// round from rest, null if that is unknown; `frame_time` that of the scene [s].
std::optional<Hash> cycle_key(const std::optional<Hash>& round, double frame_time);

/// The keys of one surface's states, from the first frame on. States with the same key are
/// bit-identical. A key depends only on the values sampled until its frame: not on how the scene
/// expresses them, nor on later values.
class KeyChain {
 public:
  explicit KeyChain(const std::optional<Hash>& first) : keys_{first} {}

  /// Number of frames whose keys are known.
  int length() const { return static_cast<int>(keys_.size()); }

  /// Frames are counted from 0, where the surface is at rest, or a cycle begins. Requires: `frame`
  /// < length().
  const std::optional<Hash>& at(int frame) const { return keys_[static_cast<std::size_t>(frame)]; }

  /// Requires: the first key is known.
  const Hash& rest() const { return *keys_.front(); }

  /// Appends a frame, after a step at scene frame `frame`; null: nothing acted, so the state did
  /// not change.
  void append(const SurfaceInputs* inputs, int frame);

 private:
  std::vector<std::optional<Hash>> keys_;
};

}  // namespace pliant
