#include "pliant/body/grid_body.hpp"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "pliant/body/field_rows.hpp"
#include "pliant/body/recovery.hpp"
#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/swing.hpp"
#include "pliant/region/region.hpp"

namespace pliant {
namespace {

// Tangents apply to the sides at the ends of the whole region, which a ring does not have; SPEC 5.
EdgeTangents tangents_of(const Grid& grid, const Patch& patch, const Region& region,
                         EdgeTangents tangents) {
  const Box& box = patch.box;
  const bool is_ring_u = grid.is_ring_u(region.box), is_ring_v = grid.is_ring_v(region.box);
  const auto are_same = [](int line, int other, int count) {
    return line % count == other % count;  // counted round
  };
  if (is_ring_u || !are_same(box.i0, region.box.i0, grid.columns)) tangents.su0.setZero();
  if (is_ring_u || !are_same(box.i1, region.box.i1, grid.columns)) tangents.su1.setZero();
  if (is_ring_v || !are_same(box.j0, region.box.j0, grid.rows)) tangents.sv0.setZero();
  if (is_ring_v || !are_same(box.j1, region.box.j1, grid.rows)) tangents.sv1.setZero();
  return tangents;
}

// Whether a force has a box on the rest mesh, deformation or force box, that is empty now.
bool is_lost(const ForceSelection& at_rest, const ForceSelection& now) {
  return (now.deformation.is_empty() && !at_rest.deformation.is_empty()) ||
         (now.force.is_empty() && !at_rest.force.is_empty());
}

// The rectangle, if a frame solves nothing else; an empty box: there are several patches, or the
// patch has another outline or crosses a seam.
Box lone_rectangle(const Grid& grid, std::span<const Region> regions) {
  const Patch* lone = nullptr;
  for (const Region& region : regions) {
    for (const Patch& patch : region.patches) {
      if (lone || !patch.is_rectangle()) return {};
      lone = &patch;
    }
  }
  return lone && holds(grid.box(), lone->box) ? lone->box : Box{};
}

bool is_outline_of(const Outline& outline, const Patch& patch) {
  const Grid& grid = outline.grid();
  return grid == patch.grid(grid) && outline.mask() == patch.interior &&
         outline.edges() == Outline(grid, patch.edges).edges();
}

std::string not_held(bool is_whole) {
  if (is_whole) {
    return "nothing holds a static surface: give it a density or a damping, or a clamped edge or "
           "two pinned ones";
  }
  return "nothing holds a static surface that is closed along u and v: give it a density or a "
         "damping, or select less: the forces select all of it";
}

}  // namespace

// A patch with a mask has clamped edges.
Outline outline_of(const Grid& grid, const Patch& patch) {
  if (!patch.interior.empty()) return {patch.grid(grid), patch.interior};
  return {patch.grid(grid), patch.edges};
}

std::shared_ptr<const NodeFactors> factors_on(const Grid& grid, const Patch& patch,
                                              const std::shared_ptr<const NodeFactors>& factors) {
  if (!factors || patch.box == grid.box()) return factors;
  const auto part_of = [&](const std::vector<double>& all) {
    std::vector<double> part;
    if (all.empty()) return part;
    const Box& box = patch.box;
    part.reserve(static_cast<std::size_t>(box.columns()) * static_cast<std::size_t>(box.rows()));
    for (int j = box.j0; j <= box.j1; ++j) {
      for (int i = box.i0; i <= box.i1; ++i)
        part.push_back(all[static_cast<std::size_t>(grid.node_round(i, j))]);
    }
    return part;
  };
  const auto& [density, damping, b, c, d, yield, hardening] = *factors;
  NodeFactors part{part_of(density), part_of(damping), part_of(b),        part_of(c),
                   part_of(d),       part_of(yield),   part_of(hardening)};
  return std::make_shared<const NodeFactors>(std::move(part));
}

double poisson_of(const BodyInputs& inputs, const Patch& patch, const NodeFactors* factors) {
  const bool acts = patch.edges.have_free() || (factors && factors->have_stiffness()) || inputs.law;
  return acts ? inputs.poisson : 0;
}

GridBody::GridBody(const Grid& grid, Field rest, const BodySettings& settings, SolverChoice solver,
                   RunContext context, std::shared_ptr<const NodeFactors> factors)
    : Body(std::move(rest), grid.node_count(), settings, std::move(factors)),
      grid_(grid),
      context_(std::move(context)),
      solvers_(solver, context_) {
  PLIANT_EXPECTS(grid_.columns >= 3 && grid_.rows >= 3 && rest_.rows() == grid_.node_count());
}

Result<StepPlan> GridBody::look(const BodyInputs& inputs) const {
  BodyWorkspace work;
  if (auto planned = plan(inputs, work); !planned) return fail(planned.error());
  return std::move(work.plan);
}

Push GridBody::push_of(const BodyInputs& inputs, const StepPlan& plan, std::size_t force) const {
  Field room;
  return pliant::push_of(grid_, {measured(inputs, room), inputs.transform, densities()},
                         inputs.forces[force], plan.selection.forces[force].force,
                         plan.selection.patches_of_force(force));
}

Result<void> GridBody::plan(const BodyInputs& inputs, BodyWorkspace& work) const {
  StepPlan& plan = work.plan;
  Selection& selection = plan.selection;
  PLIANT_EXPECTS(fits(inputs));
  work.tiles.update(grid_, {measured(inputs, work.measured), inputs.transform, densities()});
  if (!work.tiles.are_finite()) {
    return fail(ErrorCode::NotFinite, "a position in world space is not finite");
  }
  plan.steps = steps_of(inputs, settings_, factors_.get());
  plan.is_whole = settings_.region == SolvedRegion::All;
  const Box all = grid_.box();
  selection = reselected(std::move(selection), work.tiles, inputs.forces, settings_.combine,
                         inputs.selectors, std::span(&all, plan.is_whole ? 1 : 0));
  if (plan.is_whole) {
    for (Patch& patch : selection.regions[0].patches) patch.edges = settings_.edges;
  }
  if (settings_.measure == Measure::Current) find_lost(inputs, work);
  if (recovers()) {
    plan.recovering = recovering_nodes(grid_, state_.unsettled, selection.regions, work.marks,
                                       std::move(plan.recovering));
    if (!plan.recovering.empty()) {
      selection =
          recombined(std::move(selection), settings_.combine, boxes_around(grid_, plan.recovering));
    }
    plan.settling = settling_nodes(grid_, rest_, state_.positions, state_.velocities,
                                   selection.regions, work.marks, std::move(plan.settling));
  }
  for (std::size_t k = 0; k < inputs.forces.size(); ++k) {
    ForceSelection& force = selection.forces[k];
    force.pushes = pushes(grid_, work.tiles.nodes(), inputs.forces[k], force.force,
                          selection.patches_of_force(k));
  }
  return {};
}

// Finds the forces that lost their nodes. Selects on the rest mesh only for forces with an empty
// box.
void GridBody::find_lost(const BodyInputs& inputs, BodyWorkspace& work) const {
  bool has_rest_tiles = false;
  for (std::size_t k = 0; k < inputs.forces.size(); ++k) {
    const SampledForce& force = inputs.forces[k];
    ForceSelection& now = work.plan.selection.forces[k];
    const bool holds_region = force.deformation_radius == 0 || !now.deformation.is_empty();
    const bool holds_load = force.force_radius == 0 || !now.force.is_empty();
    if (holds_region && holds_load) continue;
    if (!has_rest_tiles) work.rest_tiles.update(grid_, {rest_at(inputs), inputs.transform});
    has_rest_tiles = true;
    now.is_lost = is_lost(boxes_of(work.rest_tiles, force), now);
  }
}

Result<void> GridBody::step(const BodyInputs& inputs) {
  if (inputs.forces.empty() && waits_for_forces()) {
    work_.plan = {};
    return {};
  }
  StageTimer planning(context_.profile, Stage::Selection);
  if (auto planned = plan(inputs, work_); !planned) return planned;
  planning.stop();
  if (context_.is_stopped()) return interrupted();
  if (!work_.plan.solves()) {
    put_at_rest(work_.plan.settling);
    return {};
  }
  // Builds the next state beside the current one, which is kept until the next one is complete.
  StageTimer beginning(context_.profile, Stage::StateOut);
  begin_next();
  beginning.stop();
  if (auto solved = solve(inputs); !solved) return solved;
  if (context_.is_stopped()) return interrupted();
  const StageTimer ending(context_.profile, Stage::StateOut);
  if (remembers_push()) keep_push(inputs);
  return take();
}

// Nodes that no solve moves: they stay in place or are put at rest, without velocity.
void GridBody::begin_next() {
  const StepPlan& plan = work_.plan;
  const Box hole = plan.settling.empty() ? lone_rectangle(grid_, plan.selection.regions) : Box{};
  copy_around(grid_, hole, state_.positions, work_.next_positions);
  clear_around(grid_, hole, work_.next_velocities);
  for (const int node : plan.settling) work_.next_positions.row(node) = rest_.row(node);
}

// Destroys the solvers that the frame does not need.
void GridBody::keep_solvers() {
  const std::vector<Region>& regions = work_.plan.selection.regions;
  std::vector<PatchSolve>& solves = work_.solves;
  std::size_t count = 0;
  bool are_same = true;
  for (const Region& region : regions) {
    for (const Patch& patch : region.patches) {
      are_same =
          are_same && count < solves.size() && is_outline_of(solves[count].problem.outline, patch);
      ++count;
    }
  }
  if (are_same && count == solves.size()) return;
  std::vector<Outline> outlines;
  for (const Region& region : regions) {
    for (const Patch& patch : region.patches) {
      outlines.push_back(outline_of(grid_, patch));
    }
  }
  solvers_.keep_only(outlines);
  solves.resize(count);
  for (std::size_t k = 0; k < count; ++k) solves[k].problem.outline = std::move(outlines[k]);
}

// Takes the factors of a patch, unless it has them already.
void GridBody::fit_factors(const Patch& patch, PatchSolve& one) const {
  if (one.box == patch.box) return;
  one.problem.factors = factors_on(grid_, patch, factors_);
  one.box = patch.box;
}

// Those of a region, whose patches begin at `place` among the solves: with a damping ratio, the
// slowest vibration of all its patches decides.
Result<Dynamics> GridBody::dynamics_of(const BodyInputs& inputs, const Region& region,
                                       std::size_t place) {
  if (!inputs.asks_for_vibrations()) return inputs.dynamics;
  const StageTimer timer(context_.profile, Stage::SetUp);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < region.patches.size(); ++k) {
    PatchSolve& one = work_.solves[place + k];
    fit_factors(region.patches[k], one);
    PlateSystem system{one.problem.outline, inputs.stiffness, 0};
    system.poisson = poisson_of(inputs, region.patches[k], factors_.get());
    system.factors = one.problem.factors;
    const auto lambda = vibrations_.smallest(solvers_.solver_of(system.outline), system);
    if (!lambda) return fail(lambda.error());
    least = std::min(least, *lambda);
  }
  return damped_by_ratio(inputs.dynamics, *inputs.damping_ratio, least);
}

Result<void> GridBody::solve(const BodyInputs& inputs) {
  const StepPlan& plan = work_.plan;
  keep_solvers();
  const bool from_rest = settings_.reference == Reference::Rest;
  // Nodes that settle are put at rest before the solve.
  const Field& positions = plan.settling.empty() ? state_.positions : work_.next_positions;
  const Matrix3d to_object = inverse_linear(inputs.transform);
  std::size_t place = 0;
  for (std::size_t k = 0; k < plan.selection.regions.size(); ++k) {
    const Region& region = plan.selection.regions[k];
    if (!region.is_solved()) continue;
    const double length = recovers() ? settling_length(grid_, rest_at(inputs), region) : 0;
    const auto dynamics = dynamics_of(inputs, region, place);
    if (!dynamics) return fail(dynamics.error());
    for (const Patch& patch : region.patches) {
      if (!patch.is_held() && !resists_motion(*dynamics, plan.steps.solved_length())) {
        return fail(ErrorCode::SolverFailed, not_held(plan.is_whole));
      }
      if (context_.is_stopped()) return interrupted();
      PatchSolve& one = work_.solves[place++];
      PlateProblem& problem = one.problem;
      const Box& box = patch.box;
      one.patch = &patch;
      one.settling_length = length;
      problem.stiffness = inputs.stiffness;
      problem.poisson = poisson_of(inputs, patch, factors_.get());
      fit_factors(patch, one);
      problem.dynamics = *dynamics;
      problem.tangents = tangents_of(grid_, patch, region, inputs.tangents);
      problem.law = inputs.law;
      {
        const StageTimer timer(context_.profile, Stage::Load);
        problem.load = assemble_load(grid_, work_.tiles.nodes(), inputs.forces, plan.selection, k,
                                     box, to_object, std::move(problem.load));
        if (remembers_push()) {
          begin_load(box, problem);
          problem.first_tangents =
              tangents_of(grid_, patch, region, first_tangents(inputs.tangents));
        }
      }
      if (context_.is_stopped()) return interrupted();
      {
        const StageTimer timer(context_.profile, Stage::StateIn);
        Field& displacement = one.plate.displacement;
        displacement = from_rest
                           ? difference_of(grid_, box, positions, rest_, std::move(displacement))
                           : rows_of(grid_, box, positions, std::move(displacement));
        one.plate.velocity = rows_of(grid_, box, state_.velocities, std::move(one.plate.velocity));
        if (settings_.yields)
          one.plate.plastic = rows_of(grid_, box, state_.plastic, std::move(one.plate.plastic));
      }
      PlateSolver& solver = solvers_.solver_of(problem.outline);
      auto next = solver.advance(problem, plan.steps, std::move(one.plate));
      if (!next) return fail(next.error());
      one.plate = *std::move(next);
    }
  }
  return {};
}

// The load that a patch begins with: that of the last solve, at nodes which it moved.
void GridBody::begin_load(const Box& box, PlateProblem& problem) const {
  problem.first_load = problem.load;
  for (int j = box.j0; j <= box.j1; ++j) {
    for (int i = box.i0; i <= box.i1; ++i) {
      const int node = grid_.node_round(i, j);
      if (!state_.last.unknowns[static_cast<std::size_t>(node)]) continue;
      const Eigen::Index row = Eigen::Index{j - box.j0} * box.columns() + (i - box.i0);
      problem.first_load.row(row) = state_.last.loads.row(node);
    }
  }
}

// Calls f(solve, i, j) for the nodes that the solves move.
template <class F>
void GridBody::for_each_moved(const F& f) const {
  for (const PatchSolve& one : work_.solves) {
    const Box inner = one.patch->inner();
    for (int j = inner.j0; j <= inner.j1; ++j) {
      for (int i = inner.i0; i <= inner.i1; ++i) {
        if (one.patch->holds(i, j)) f(one, i, j);
      }
    }
  }
}

void GridBody::keep_push(const BodyInputs& inputs) {
  LastPush& next = work_.next_push;
  next = nothing_pushed();
  next.tangents = inputs.tangents;
  for_each_moved([&](const PatchSolve& one, int i, int j) {
    const int node = grid_.node_round(i, j);
    const Box& box = one.patch->box;
    const Eigen::Index row = Eigen::Index{j - box.j0} * box.columns() + (i - box.i0);
    next.loads.row(node) = one.problem.load.row(row);
    next.unknowns[static_cast<std::size_t>(node)] = 1;
  });
}

// Makes the solution the state, all of it or nothing. The rim is not written: rest + (position -
// rest) may round.
Result<void> GridBody::take() {
  const Field* const reference = settings_.reference == Reference::Rest ? &rest_ : nullptr;
  for (const PatchSolve& one : work_.solves) {
    if (!put_interior(grid_, *one.patch, one.plate.displacement, one.plate.velocity, reference,
                      work_.next_positions, work_.next_velocities)) {
      return fail(ErrorCode::NotFinite, "the state stopped being finite");
    }
  }
  if (settings_.yields) {
    work_.next_plastic = state_.plastic;
    for (const PatchSolve& one : work_.solves)
      put_rows(grid_, one.patch->box, one.plate.plastic, work_.next_plastic);
    if (!work_.next_plastic.allFinite())
      return fail(ErrorCode::NotFinite, "the state stopped being finite");
    state_.plastic.swap(work_.next_plastic);
  }
  if (recovers()) mark_unsettled();
  state_.positions.swap(work_.next_positions);
  state_.velocities.swap(work_.next_velocities);
  if (remembers_push()) std::swap(state_.last, work_.next_push);
  return {};
}

// Requires: the next positions are complete, but not yet in the state.
void GridBody::mark_unsettled() {
  std::fill(state_.unsettled.begin(), state_.unsettled.end(), std::uint8_t{0});
  for_each_moved([&](const PatchSolve& one, int i, int j) {
    const int node = grid_.node_round(i, j);
    const auto position = work_.next_positions.row(node);
    const double displacement = length_of(position - rest_.row(node));
    const double motion = length_of(position - state_.positions.row(node));
    const double larger = std::max(displacement, motion);
    state_.unsettled[static_cast<std::size_t>(node)] = larger > 0 && larger >= one.settling_length;
  });
}

}  // namespace pliant
