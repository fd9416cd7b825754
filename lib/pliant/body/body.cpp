#include "pliant/body/body.hpp"

#include <algorithm>
#include <utility>

#include "pliant/core/expects.hpp"

namespace pliant {

bool StepPlan::selects() const {
  return surface ? !surface->pieces.empty() : !selection.regions.empty();
}

bool StepPlan::solves() const { return unknown_count() > 0; }

int StepPlan::unknown_count() const {
  int count = 0;
  for (const Region& region : selection.regions) {
    for (const Patch& patch : region.patches) count += patch.interior_count();
  }
  if (!surface) return count;
  for (const SurfacePiece& piece : surface->pieces) {
    if (piece.moves()) count += piece.free_nodes;
  }
  return count;
}

bool StepPlan::is_held() const {
  for (const Region& region : selection.regions) {
    for (const Patch& patch : region.patches) {
      if (!patch.is_held()) return false;
    }
  }
  if (!surface) return true;
  return std::all_of(surface->pieces.begin(), surface->pieces.end(),
                     [](const SurfacePiece& piece) { return piece.is_held() || !piece.moves(); });
}

TimeSteps steps_of(const BodyInputs& inputs, const BodySettings& settings) {
  TimeSteps steps = divide_interval(inputs.frame_length, inputs.dt, settings.stepping);
  if (inputs.dynamics.density > 0) steps.integrator = settings.integrator;
  return steps;
}

Body::Body(Field rest, const BodySettings& settings)
    : rest_(std::move(rest)), settings_(settings), state_(rest_state()) {}

BodyState Body::rest_state() const {
  BodyState state{rest_, Field::Zero(rest_.rows(), 3)};
  if (recovers()) state.unsettled.assign(static_cast<std::size_t>(rest_.rows()), 0);
  return state;
}

void Body::restore(BodyState state) {
  PLIANT_EXPECTS(state.positions.rows() == rest_.rows());
  PLIANT_EXPECTS(state.velocities.rows() == rest_.rows());
  PLIANT_EXPECTS(state.unsettled.size() == state_.unsettled.size());
  state_ = std::move(state);
}

}  // namespace pliant
