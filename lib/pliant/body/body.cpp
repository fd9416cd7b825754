#include "pliant/body/body.hpp"

#include <algorithm>
#include <utility>

#include "pliant/core/expects.hpp"

namespace pliant {

bool StepPlan::selects() const {
  return surface ? !surface->patches.empty() : !selection.regions.empty();
}

bool StepPlan::solves() const { return unknown_count() > 0; }

int StepPlan::unknown_count() const {
  int count = 0;
  for (const Region& region : selection.regions) {
    for (const Patch& patch : region.patches) count += patch.interior_count();
  }
  if (!surface) return count;
  for (const TrianglePatch& patch : surface->patches) {
    if (patch.moves()) count += patch.free_nodes;
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
  return std::all_of(surface->patches.begin(), surface->patches.end(),
                     [](const TrianglePatch& patch) { return patch.is_held() || !patch.moves(); });
}

Dynamics acting_dynamics(const Dynamics& dynamics, const NodeFactors* factors) {
  if (!factors) return dynamics;
  const auto acting = [](double value, const std::vector<double>& of_nodes) {
    const bool is_somewhere =
        of_nodes.empty() || std::ranges::any_of(of_nodes, [](double factor) { return factor > 0; });
    return is_somewhere ? value : 0;
  };
  return {acting(dynamics.density, factors->density), acting(dynamics.damping, factors->damping)};
}

TimeSteps steps_of(const BodyInputs& inputs, const BodySettings& settings,
                   const NodeFactors* factors) {
  if (settings.integrator == Integrator::Exact) {
    const Dynamics dynamics = acting_dynamics(inputs.dynamics, factors);
    const bool is_static = dynamics.density == 0 && dynamics.damping == 0;
    if (is_static) return {1, inputs.frame_length};
    return {settings.exact_parts, inputs.frame_length, Integrator::Exact};
  }
  TimeSteps steps = divide_interval(inputs.frame_length, inputs.dt, settings.stepping);
  if (acting_dynamics(inputs.dynamics, factors).density > 0) steps.integrator = settings.integrator;
  return steps;
}

Body::Body(Field rest, Eigen::Index plastic_places, const BodySettings& settings,
           std::shared_ptr<const NodeFactors> factors, std::shared_ptr<const NodeMarks> held,
           std::shared_ptr<const NodeFaces> faces)
    : rest_(std::move(rest)),
      plastic_places_(plastic_places),
      settings_(settings),
      factors_(std::move(factors)),
      held_(std::move(held)),
      faces_(std::move(faces)) {
  if (settings_.is_animated) rest_.setZero();
  state_ = rest_state();
}

const Field& Body::measured(const BodyInputs& inputs, Field& room) const {
  if (settings_.measure == Measure::Rest) return rest_at(inputs);
  if (!inputs.shape) return state_.positions;
  room = *inputs.shape + state_.positions;
  return room;
}

BodyState Body::rest_state() const {
  BodyState state{rest_, Field::Zero(rest_.rows(), 3)};
  if (recovers()) state.unsettled.assign(static_cast<std::size_t>(rest_.rows()), 0);
  if (remembers_push()) state.last = nothing_pushed();
  if (settings_.yields) state.plastic.setZero(plastic_places_, 9);
  return state;
}

LastPush Body::nothing_pushed() const {
  return {Field::Zero(rest_.rows(), 3),
          std::vector<std::uint8_t>(static_cast<std::size_t>(rest_.rows())),
          {}};
}

EdgeTangents Body::first_tangents(const EdgeTangents& now) const {
  const auto& unknowns = state_.last.unknowns;
  const bool is_first = std::find(unknowns.begin(), unknowns.end(), 1) == unknowns.end();
  return is_first ? now : state_.last.tangents;
}

void Body::put_at_rest(const std::vector<int>& nodes) {
  for (const int node : nodes) {
    state_.positions.row(node) = rest_.row(node);
    state_.velocities.row(node).setZero();
    state_.unsettled[static_cast<std::size_t>(node)] = 0;
    if (!remembers_push()) continue;
    state_.last.loads.row(node).setZero();
    state_.last.unknowns[static_cast<std::size_t>(node)] = 0;
  }
}

void Body::restore(BodyState state) {
  PLIANT_EXPECTS(state.positions.rows() == rest_.rows());
  PLIANT_EXPECTS(state.velocities.rows() == rest_.rows());
  PLIANT_EXPECTS(state.unsettled.size() == state_.unsettled.size());
  PLIANT_EXPECTS(state.last.unknowns.size() == state_.last.unknowns.size());
  PLIANT_EXPECTS(state.last.loads.rows() == state_.last.loads.rows());
  PLIANT_EXPECTS(state.plastic.rows() == state_.plastic.rows());
  state_ = std::move(state);
}

}  // namespace pliant
