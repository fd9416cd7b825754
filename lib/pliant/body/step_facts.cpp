#include "pliant/body/step_facts.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "pliant/region/closed_boxes.hpp"
#include "pliant/region/combine.hpp"
#include "pliant/region/region.hpp"

namespace pliant {
namespace {

// Whether any node in the box moves.
bool moves_any(const Grid& grid, std::span<const Patch> patches, const Box& box) {
  bool moves = false;
  for (const Patch& patch : patches) {
    for_each_shared(grid, patch.box, box, [&](const Box& inside) {
      for (int j = inside.j0; j <= inside.j1 && !moves; ++j) {
        for (int i = inside.i0; i <= inside.i1 && !moves; ++i) moves = patch.holds(i, j);
      }
    });
    if (moves) return true;
  }
  return false;
}

// Whether any two of the boxes meet; if so, merges them.
bool merge_two(const Grid& grid, std::vector<Box>& boxes) {
  for (std::size_t a = 0; a < boxes.size(); ++a) {
    for (std::size_t b = a + 1; b < boxes.size(); ++b) {
      if (!meet(grid, boxes[a], boxes[b])) continue;
      boxes[a] = box_around(grid, std::array{boxes[a], boxes[b]});
      boxes[b] = boxes.back();
      boxes.pop_back();
      return true;
    }
  }
  return false;
}

// Of a force that selects nothing: all is solved.
ForceFacts facts_of_push(bool has_magnitude, bool pushes, bool is_lost) {
  ForceFacts facts;
  facts.touches = true;
  facts.is_lost = is_lost;
  facts.is_push_awaited = has_magnitude && !is_lost;
  facts.pushes = pushes;
  return facts;
}

ForceFacts facts_of(std::size_t k, const BodyInputs& inputs, const Selection& selection,
                    Combine combine) {
  const ForceSelection& selected = selection.forces[k];
  const std::span<const Patch> patches = selection.patches_of_force(k);
  const bool is_solved = !patches.empty();
  const bool reaches =
      is_solved && overlaps(selection.grid, selection.regions[selected.region], selected.force);
  // The solved part of a union may be somewhere else.
  const bool is_elsewhere =
      combine == Combine::Union && !moves_any(selection.grid, patches, selected.deformation);
  const bool has_magnitude = inputs.forces[k].magnitude != 0;
  const bool selects_itself =
      inputs.selectors.empty() || inputs.selectors[k] == static_cast<int>(k);
  ForceFacts facts;
  facts.is_too_small = (!is_solved || is_elsewhere) && !selected.deformation.is_empty();
  facts.is_outside = is_solved && !selected.force.is_empty() && !reaches && has_magnitude;
  facts.touches = !selects_itself || !selected.deformation.is_empty() || reaches;
  facts.is_lost = selected.is_lost;
  // Another warning about this frame replaces this one.
  const bool is_here = reaches || (facts.touches && selected.force.is_empty());
  const bool is_told = facts.is_lost || (is_elsewhere && !selected.deformation.is_empty());
  facts.is_push_awaited = is_solved && has_magnitude && is_here && !is_told;
  facts.pushes = selected.pushes;
  return facts;
}

ForceFacts facts_of(std::size_t k, const BodyInputs& inputs, const TriangleSelection& selection,
                    bool is_solved) {
  const TriangleForceSelection& selected = selection.forces[k];
  const bool has_magnitude = inputs.forces[k].magnitude != 0;
  const bool is_inside = selected.counts.inside_nodes > 0;
  ForceFacts facts;
  facts.is_between_nodes = selected.selects && !is_inside && selected.is_near;
  facts.is_too_small =
      is_inside && std::all_of(selection.patches.begin(), selection.patches.end(),
                               [](const TrianglePatch& patch) { return patch.free_nodes == 0; });
  facts.is_outside = is_solved && has_magnitude && selected.acts_outside;
  facts.touches = !selected.selects || is_inside || facts.is_between_nodes || selected.acts_inside;
  facts.is_lost = selected.is_lost;
  facts.is_push_awaited =
      is_solved && has_magnitude && facts.touches && !selected.acts_outside && !selected.is_lost;
  facts.pushes = selected.push.node_count > 0;
  return facts;
}

StepFacts facts_of(const BodyInputs& inputs, const StepPlan& plan,
                   const TriangleSelection& selection, StepFacts facts) {
  facts.is_solved = plan.solves();
  facts.is_surface = true;
  facts.has_loose_patch = std::any_of(
      selection.patches.begin(), selection.patches.end(),
      [](const TrianglePatch& patch) { return patch.free_nodes > 0 && !patch.moves(); });
  facts.forces.clear();
  for (std::size_t k = 0; k < selection.forces.size(); ++k) {
    const TriangleForceSelection& force = selection.forces[k];
    facts.forces.push_back(plan.is_whole ? facts_of_push(inputs.forces[k].magnitude != 0,
                                                         force.push.node_count > 0, force.is_lost)
                                         : facts_of(k, inputs, selection, facts.is_solved));
  }
  return facts;
}

}  // namespace

bool falls_apart(const Selection& selection, std::vector<Box>& room) {
  const Grid& grid = selection.grid;
  // Usually all boxes meet the first one, or boxes merged with it.
  const Box all = selection.box();
  Box met;
  for (bool grows = true; grows && met != all;) {
    grows = false;
    for (const ForceSelection& force : selection.forces) {
      const Box& box = force.deformation;
      if (box.is_empty() || (!met.is_empty() && !meet(grid, met, box))) continue;
      const Box before = met;
      met = box_around(grid, std::array{met, box});
      grows = grows || met != before;
    }
  }
  if (met == all) return false;
  room.assign(1, met);
  for (const ForceSelection& force : selection.forces) {
    const Box& box = force.deformation;
    if (!box.is_empty() && !meet(grid, met, box)) room.push_back(box);
  }
  constexpr std::size_t few = 16;  // in their own memory: this is asked in each frame
  if (room.size() > few) return merged(room, grid).size() > 1;
  while (merge_two(grid, room)) {
  }
  return room.size() > 1;
}

StepFacts facts_of(const BodyInputs& inputs, const StepPlan& plan, Combine combine,
                   StepFacts reuse) {
  if (plan.surface) return facts_of(inputs, plan, *plan.surface, std::move(reuse));
  const Selection& selection = plan.selection;
  StepFacts facts = std::move(reuse);
  facts.is_solved = plan.solves();
  facts.forces.clear();
  for (std::size_t k = 0; k < selection.forces.size(); ++k) {
    const ForceSelection& force = selection.forces[k];
    facts.forces.push_back(
        plan.is_whole ? facts_of_push(inputs.forces[k].magnitude != 0, force.pushes, force.is_lost)
                      : facts_of(k, inputs, selection, combine));
  }
  if (combine == Combine::Box && facts.is_solved && falls_apart(selection, facts.room)) {
    for (std::size_t k = 0; k < facts.forces.size(); ++k) {
      facts.forces[k].is_apart = !selection.forces[k].deformation.is_empty();
    }
  }
  return facts;
}

}  // namespace pliant
