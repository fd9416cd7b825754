#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pliant/body/settings.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/core/hash.hpp"
#include "pliant/plate/solver_choice.hpp"

namespace pliant {

struct SurfaceInputs;

// Names for states, made of everything that a state comes from. Not for other rooms.

/// Of a surface at rest under this engine: its grid and rest positions, the choices of its body and
/// who solves. Another engine, one whose sources differ in a byte, gives other keys.
Hash rest_key(const Grid& grid, const Field& rest, const BodySettings& settings,
              SolverChoice solver);

/// Of any state of a surface that nothing better is known of.
Hash unnamed_key(const Hash& rest);

/// Of the state that a step at `frame` with these inputs makes of the state of key `before`. None
/// where a custom force without a key of its own acts: nobody knows what its functions will do.
std::optional<Hash> next_key(const Hash& before, const SurfaceInputs& inputs, int frame);

/// The keys of one surface's states, from the first frame on. Two of one key are the same, bit for
/// bit, and what a key tells of a frame is what was sampled until then: not how the scene says it,
/// nor what comes later.
class KeyChain {
 public:
  explicit KeyChain(const Hash& rest) : keys_{rest} {}

  /// Number of frames whose keys are known.
  int length() const { return static_cast<int>(keys_.size()); }

  /// Frames are counted from 0, where the surface is at rest. Requires: `frame` < length().
  const std::optional<Hash>& at(int frame) const { return keys_[static_cast<std::size_t>(frame)]; }

  const Hash& rest() const { return *keys_.front(); }

  /// One more frame, after a step at scene frame `frame`; null: nothing acted, the state stays.
  void append(const SurfaceInputs* inputs, int frame);

 private:
  std::vector<std::optional<Hash>> keys_;
};

}  // namespace pliant
