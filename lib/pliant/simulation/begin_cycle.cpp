#include <string>
#include <utility>

#include "pliant/body/cycle.hpp"
#include "pliant/simulation/bodies.hpp"

namespace pliant {

// Puts a body at the beginning of its cycle.
Result<void> Bodies::begin_cycle(std::size_t index, SceneStates* states) {
  Body& body = *bodies_[index];
  std::optional<BodyState>& cycle = cycles_[index];
  const bool is_known = cycle.has_value();
  if (!is_known && states) cycle = states->cycle(index, body);
  steps_[index].is_read = !is_known && cycle.has_value();
  if (!cycle) {
    auto found = find_cycle(index);
    if (!found) return fail(found.error());
    cycle = *std::move(found);
  }
  body.restore(*cycle);
  if (!is_known && !steps_[index].is_read && states) states->write_cycle(index, body);
  return {};
}

Result<BodyState> Bodies::find_cycle(std::size_t index) {
  const Surface& surface = scene_.surfaces[index];
  Body& body = *bodies_[index];
  Step& step = steps_[index];
  const int first = first_solved_frame(scene_, surface);
  SurfaceInputs inputs;
  CycleRound round{.frames = surface.solver.loop.value(),
                   .frame_time = 1 / scene_.fps,
                   .memory = context_.memory};
  round.advance = [&](int frame) -> Result<void> {
    step.frame = first + frame;
    if (context_.is_stopped()) return interrupted();
    if (!is_solved_at(scene_, surface, step.frame)) return {};
    inputs = sample_inputs(scene_, sampling_, index, step.frame, std::move(inputs));
    auto stepped = body.step(inputs.body);
    if (std::string fault = inputs.faults->first(); !fault.empty())
      return fail(ErrorCode::InvalidInput, std::move(fault));
    return stepped;
  };
  if (round_done_) {
    round.told = [&](int number, double gap) { round_done_(surface.name, number, gap); };
  }
  auto found = pliant::find_cycle(body, round);
  if (found || found.error().code != ErrorCode::InvalidInput) return found;
  Error error = found.error();
  error.code = ErrorCode::NotFinite;  // of a custom force, whatever state it was asked from
  return fail(std::move(error));
}

}  // namespace pliant
