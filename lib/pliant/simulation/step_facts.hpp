#pragma once

#include <string_view>
#include <vector>

#include "pliant/simulation/sampling.hpp"
#include "pliant/simulation/warning_log.hpp"

namespace pliant {

// What a step leaves behind for warnings, apart from the names of a scene: it can be kept with the
// state that the step made. Not for other rooms.

/// Of a force, in the order of the step's inputs.
struct ForceFacts {
  bool is_too_small = false;     ///< it selects nodes, but too few are solved
  bool is_outside = false;       ///< it has a magnitude, and its box lies outside the region
  bool touches = false;          ///< it selects a node, or reaches the region
  bool is_push_awaited = false;  ///< its magnitude should move something, in this frame or another
  bool pushes = false;           ///< it moves a node
  bool is_lost = false;          ///< it holds nodes of the rest mesh, but none as it stands

  bool is_apart = false;  ///< boxes that do not meet make one region, and its own is one of them

  friend bool operator==(const ForceFacts&, const ForceFacts&) = default;
};

struct StepFacts {
  bool is_solved = false;
  std::vector<ForceFacts> forces = {};
  std::vector<Box> room = {};  ///< to work in, no fact

  friend bool operator==(const StepFacts& a, const StepFacts& b) {
    return a.is_solved == b.is_solved && a.forces == b.forces;
  }
};

/// Whether what the forces select would be several islands, in a region that is one box. `room`: to
/// work in.
bool falls_apart(const Selection& selection, std::vector<Box>& room);

/// In the memory of `reuse`, facts of an earlier step or none.
StepFacts facts_of(const SurfaceInputs& inputs, const StepReport& report, Combine combine,
                   StepFacts reuse = {});

/// Tells the log of one surface's step at a frame.
void add_facts(WarningLog& log, std::string_view surface, int frame, const SurfaceInputs& inputs,
               const StepFacts& facts);

}  // namespace pliant
