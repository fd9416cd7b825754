#include "pliant/body/elastic_body.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/swing.hpp"

namespace pliant {

Result<void> ElasticBody::step(const BodyInputs& inputs) {
  if (inputs.forces.empty() && !inputs.selects_by_colliders() && waits_for_forces()) {
    plan_ = {};
    touch_nothing();
    return {};
  }
  StageTimer planning(context_.profile, Stage::Selection);
  if (auto selected = select(inputs, plan_); !selected) return selected;
  planning.stop();
  if (context_.is_stopped()) return interrupted();
  if (!plan_.solves()) {
    put_at_rest(plan_.settling);
    touch_nothing();
    return {};
  }
  keep_patches(inputs);
  if (!inputs.colliders.empty()) {
    contact_.begin_frame({inputs, rest_at(inputs), plan_.steps.count}, inputs.colliders,
                         contact_share(), state_.contacts);
  }
  // Builds the next state beside the current one, which is kept until the next one is complete.
  StageTimer beginning(context_.profile, Stage::StateOut);
  begin_next();
  beginning.stop();
  if (auto solved = solve(inputs); !solved) return solved;
  if (context_.is_stopped()) return interrupted();
  next_.contacts.clear();
  if (!inputs.colliders.empty()) {
    contact_.end_frame([this](int node) -> Vector3d {
      return (next_.positions.row(node) - rest_.row(node)).transpose();
    });
    next_.contacts = contact_.take_facts();
  }
  const StageTimer ending(context_.profile, Stage::StateOut);
  if (remembers_push()) keep_push(inputs.tangents);
  return take();
}

// Nodes that no solve moves: they stay in place or are put at rest, without velocity.
void ElasticBody::begin_next() {
  std::span<const RowRun> hole;
  if (patch_count() == 1 && patch(0).moves && plan_.settling.empty() &&
      std::ranges::is_sorted(patch(0).moved, {}, &RowRun::node)) {
    hole = patch(0).moved;
  }
  copy_around(hole, state_.positions, next_.positions);
  clear_around(hole, rest_.rows(), next_.velocities);
  for (const int node : plan_.settling) next_.positions.row(node) = rest_.row(node);
}

Result<void> ElasticBody::solve(const BodyInputs& inputs) {
  std::size_t end = 0;
  for (std::size_t first = 0; first < patch_count(); first = end) {
    while (end < patch_count() && patch(end).region == patch(first).region) ++end;
    const auto dynamics = dynamics_of(inputs, first, end);
    if (!dynamics) return fail(dynamics.error());
    for (std::size_t k = first; k < end; ++k) {
      if (!patch(k).moves) continue;
      if (auto moved = move(inputs, *dynamics, k); !moved) return moved;
    }
  }
  return {};
}

// Those of a region: with a damping ratio, the slowest vibration of all its patches decides.
Result<Dynamics> ElasticBody::dynamics_of(const BodyInputs& inputs, std::size_t first,
                                          std::size_t end) {
  for (std::size_t k = first; k < end; ++k)
    if (patch(k).moves) take_material(inputs, k);
  if (!inputs.asks_for_vibrations()) return inputs.dynamics;
  const StageTimer timer(context_.profile, Stage::SetUp);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = first; k < end; ++k) {
    if (!patch(k).moves) continue;
    const auto lambda = smallest_eigenvalue_of(k);
    if (!lambda) return fail(lambda.error());
    least = std::min(least, *lambda);
  }
  return damped_by_ratio(inputs.dynamics, *inputs.damping_ratio, least);
}

Result<void> ElasticBody::move(const BodyInputs& inputs, const Dynamics& dynamics, std::size_t k) {
  BodyPatch& one = patch(k);
  if (!one.is_held && !resists_motion(dynamics, plan_.steps.solved_length()))
    return fail(ErrorCode::SolverFailed, not_held(k));
  if (context_.is_stopped()) return interrupted();
  PlateInterval& interval = one.interval();
  interval.dynamics = dynamics;
  interval.law = inputs.law;
  interval.tangents = tangents_of(inputs.tangents, k);
  {
    const StageTimer timer(context_.profile, Stage::Load);
    find_load(inputs, k);
    if (remembers_push()) {
      begin_load(one);
      interval.first_tangents = tangents_of(first_tangents(inputs.tangents), k);
    }
  }
  if (context_.is_stopped()) return interrupted();
  {
    const StageTimer timer(context_.profile, Stage::StateIn);
    find_displacement(k);
    one.state.velocity.resize(one.rows, 3);
    take_rows(one.nodes, state_.velocities, one.state.velocity);
    if (settings_.yields) {
      one.state.plastic.resize(one.plastic_rows, 9);
      take_rows(one.plastic, state_.plastic, one.state.plastic);
    }
  }
  const bool meets = !inputs.colliders.empty();
  if (meets) contact_.begin_patch(one.moved);
  interval.contact = meets ? &contact_ : nullptr;
  auto advanced = advance(k);
  interval.contact = nullptr;
  if (meets) contact_.end_patch();
  return advanced;
}

// The load that a patch begins with: that of the last solve, at nodes which it moved.
void ElasticBody::begin_load(BodyPatch& one) const {
  PlateInterval& interval = one.interval();
  interval.first_load = interval.load;
  for (const RowRun& run : one.nodes) {
    for (int k = 0; k < run.count; ++k) {
      const int node = run.node + k;
      if (state_.last.unknowns[static_cast<std::size_t>(node)])
        interval.first_load.row(run.row + k) = state_.last.loads.row(node);
    }
  }
}

void ElasticBody::keep_push(const EdgeTangents& tangents) {
  next_.last = nothing_pushed();
  next_.last.tangents = tangents;
  for (std::size_t k = 0; k < patch_count(); ++k) {
    BodyPatch& one = patch(k);
    if (!one.moves) continue;
    put_rows(one.moved, one.interval().load, next_.last.loads);
    for (const RowRun& run : one.moved)
      std::fill_n(next_.last.unknowns.begin() + run.node, run.count, std::uint8_t{1});
  }
}

// Makes the solution the state, all of it or nothing. The rim is not written: rest + (position -
// rest) may round.
Result<void> ElasticBody::take() {
  const Field* const reference = settings_.reference == Reference::Rest ? &rest_ : nullptr;
  bool is_finite = true;
  next_.plastic = state_.plastic;
  for (std::size_t k = 0; k < patch_count(); ++k) {
    const BodyPatch& one = patch(k);
    if (!one.moves) continue;
    is_finite =
        is_finite && put_motion(one.moved, one.state, reference, next_.positions, next_.velocities);
    if (settings_.yields) put_rows(one.plastic, one.state.plastic, next_.plastic);
  }
  if (!is_finite || !next_.plastic.allFinite())
    return fail(ErrorCode::NotFinite, "the state stopped being finite");
  mark_unsettled();
  std::swap(state_, next_);
  return {};
}

// Requires: the next positions are complete, but not yet in the state.
void ElasticBody::mark_unsettled() {
  next_.unsettled.assign(state_.unsettled.size(), 0);
  if (!recovers()) return;
  // Those of a patch that nothing holds too: they stay away from rest, and come back once it moves.
  for (std::size_t k = 0; k < patch_count(); ++k) {
    const BodyPatch& one = patch(k);
    for (const RowRun& run : one.moved) {
      for (int node = run.node; node < run.node + run.count; ++node) {
        const auto position = next_.positions.row(node);
        const double larger = std::max(length_of(position - rest_.row(node)),
                                       length_of(position - state_.positions.row(node)));
        next_.unsettled[static_cast<std::size_t>(node)] =
            larger > 0 && larger >= one.settling_length;
      }
    }
  }
}

}  // namespace pliant
