#pragma once

#include <vector>

#include "pliant/body/body.hpp"

namespace pliant {

// Facts about a step, for warnings. They contain no names of the scene, so they can be stored with
// the state that the step computed.

/// The facts about one force.
struct ForceFacts {
  bool is_too_small = false;      ///< it selects nodes, but too few are solved, or all are held
  bool is_between_nodes = false;  ///< on a surface: it reaches a face, but no node
  bool is_outside = false;        ///< its magnitude is not 0, and its force box is outside the
                                  ///< region
  bool touches = false;           ///< it selects a node, or its force box reaches the region
  bool is_push_awaited = false;   ///< it is expected to move a node, at this frame or another
  bool pushes = false;            ///< it moves a node
  bool is_lost = false;  ///< it pushes nodes of the rest mesh, but none of the present mesh

  bool is_apart = false;  ///< boxes that do not meet form one region, and its own is one of them

  friend bool operator==(const ForceFacts&, const ForceFacts&) = default;
};

struct StepFacts {
  bool is_solved = false;
  bool is_surface = false;       ///< of triangles
  bool has_loose_patch = false;  ///< on a surface: nothing holds a patch of the region
  std::vector<ForceFacts> forces = {};
  std::vector<Box> room = {};  ///< scratch memory, not a fact

  friend bool operator==(const StepFacts& a, const StepFacts& b) {
    return a.is_solved == b.is_solved && a.is_surface == b.is_surface &&
           a.has_loose_patch == b.has_loose_patch && a.forces == b.forces;
  }
};

/// Whether the boxes of the forces would form several islands, in a region that is one box. `room`:
/// scratch memory.
bool falls_apart(const Selection& selection, std::vector<Box>& room);

/// Reuses the memory of `reuse`: facts of an earlier step, or empty.
StepFacts facts_of(const BodyInputs& inputs, const StepPlan& plan, Combine combine,
                   StepFacts reuse = {});

}  // namespace pliant
