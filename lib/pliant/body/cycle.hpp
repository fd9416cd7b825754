#pragma once

#include <functional>

#include "pliant/body/body.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"

namespace pliant {

/// The most rounds in which a cycle is looked for.
inline constexpr int max_rounds = 1000;

/// What the search for a cycle needs of a body's surroundings.
struct CycleRound {
  int frames = 1;                  ///< of the cycle, >= 1
  double frame_time = 1;           ///< of the scene, which makes velocities lengths [s]
  MemoryBudget* memory = nullptr;  ///< null: no limit

  /// Advances the body over one frame, counted from 0. Errors end the search.
  std::function<Result<void>(int frame)> advance = {};

  /// Called after each round with its number, from 1 on, and its gap as a share of the largest
  /// displacement. Empty: not called.
  std::function<void(int round, double gap)> told = {};
};

/// The state at the beginning of a cycle: `frames` frames lead back to it, positions and velocities
/// times the frame's time within 1e-6 of the largest displacement of the cycle. Found by going
/// round from rest, accelerated by Anderson's method; docs/model.md, "Cycles". The body is left in
/// any state. Errors: SolverFailed after `max_rounds` rounds, with the gap; OutOfMemory; those of
/// `advance`.
Result<BodyState> find_cycle(Body& body, const CycleRound& round);

}  // namespace pliant
