#include "pliant/body/body.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/body/field_rows.hpp"
#include "pliant/body/recovery.hpp"
#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"

namespace pliant {
namespace {

double length(const Eigen::RowVector3d& a) {
  return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

// Tangents apply to the sides at the ends of the whole region; SPEC 5.
EdgeTangents tangents_of(const Patch& patch, const Region& region, EdgeTangents tangents) {
  if (patch.box.i0 != region.box.i0) tangents.su0.setZero();
  if (patch.box.i1 != region.box.i1) tangents.su1.setZero();
  if (patch.box.j0 != region.box.j0) tangents.sv0.setZero();
  if (patch.box.j1 != region.box.j1) tangents.sv1.setZero();
  return tangents;
}

std::vector<std::vector<Patch>> patches_of(const Selection& selection) {
  std::vector<std::vector<Patch>> patches;
  for (const Region& region : selection.regions) patches.push_back(patches_of(region));
  return patches;
}

// Whether a force has a box on the rest mesh, deformation or force box, that is empty now.
bool is_lost(const ForceSelection& at_rest, const ForceSelection& now) {
  return (now.deformation.is_empty() && !at_rest.deformation.is_empty()) ||
         (now.force.is_empty() && !at_rest.force.is_empty());
}

// The rectangle, if a frame solves nothing else; an empty box: there are several patches, or the
// patch has another outline.
Box lone_rectangle(const StepReport& report) {
  const Patch* lone = nullptr;
  for (const auto& some : report.patches) {
    for (const Patch& patch : some) {
      if (lone || !patch.is_rectangle()) return {};
      lone = &patch;
    }
  }
  return lone ? lone->box : Box{};
}

bool is_outline_of(const Outline& outline, const Patch& patch) {
  return outline.grid().columns == patch.box.columns() && outline.grid().rows == patch.box.rows() &&
         outline.mask() == patch.interior;
}

}  // namespace

int StepReport::unknown_count() const {
  int count = 0;
  for (const auto& some : patches) {
    for (const Patch& patch : some) count += patch.interior_count();
  }
  return count;
}

std::span<const Patch> StepReport::patches_of_force(std::size_t k) const {
  const int region = selection.forces[k].region;
  if (region < 0) return {};
  return patches[static_cast<std::size_t>(region)];
}

Body::Body(const Grid& grid, Field rest, const BodySettings& settings, SolverChoice solver,
           RunContext context)
    : grid_(grid),
      rest_(std::move(rest)),
      settings_(settings),
      profile_(context.profile),
      solvers_(solver, std::move(context)) {
  PLIANT_EXPECTS(grid_.columns >= 3 && grid_.rows >= 3 && rest_.rows() == grid_.node_count());
  reset();
}

void Body::reset() { state_ = rest_state(); }

BodyState Body::rest_state() const {
  BodyState state{rest_, Field::Zero(grid_.node_count(), 3)};
  if (recovers()) state.unsettled.assign(static_cast<std::size_t>(grid_.node_count()), 0);
  return state;
}

void Body::restore(BodyState state) {
  PLIANT_EXPECTS(state.positions.rows() == grid_.node_count());
  PLIANT_EXPECTS(state.velocities.rows() == grid_.node_count());
  PLIANT_EXPECTS(state.unsettled.size() == state_.unsettled.size());
  state_ = std::move(state);
}

Field Body::measured_nodes(const Transform& transform) const {
  return to_world(transform, settings_.measure == Measure::Rest ? rest_ : state_.positions);
}

Result<StepReport> Body::look(const BodyInputs& inputs) const {
  BodyWorkspace work;
  if (auto planned = plan(inputs, work); !planned) return fail(planned.error());
  return std::move(work.report);
}

// Writes the report of the workspace, all but the solve.
Result<void> Body::plan(const BodyInputs& inputs, BodyWorkspace& work) const {
  StepReport& report = work.report;
  work.tiles.update(grid_, {measured(), inputs.transform});
  if (!work.tiles.are_finite()) {
    return fail(ErrorCode::NotFinite, "a position in world space is not finite");
  }
  report.steps = divide_interval(inputs.frame_length, inputs.dt, settings_.stepping);
  const bool are_same =
      reselect(work.selection, work.tiles, inputs.forces, settings_.combine, inputs.selectors);
  report.selection = work.selection;
  // With recovering nodes, the patches were not those of the forces.
  if (report.recovering > 0 || !are_same) report.patches = patches_of(report.selection);
  report.lost.clear();
  if (settings_.measure == Measure::Current) {
    report.lost = lost_forces(inputs, report.selection, work, std::move(report.lost));
  }
  if (recovers()) {
    const Recovering recovering =
        recovering_nodes(grid_, state_.unsettled, report.patches, work.marks);
    report.recovering = recovering.node_count;
    if (recovering.node_count > 0) {
      report.selection =
          recombined(std::move(report.selection), settings_.combine, recovering.boxes);
      report.patches = patches_of(report.selection);
    }
    report.settling = settling_nodes(grid_, rest_, state_.positions, state_.velocities,
                                     report.patches, work.marks, std::move(report.settling));
  }
  report.is_solved = report.unknown_count() > 0;
  report.pushing.clear();
  for (std::size_t k = 0; k < inputs.forces.size(); ++k) {
    report.pushing.push_back(pushes(grid_, work.tiles.nodes(), inputs.forces[k],
                                    report.selection.forces[k].force, report.patches_of_force(k)));
  }
  return {};
}

// The forces that lost their nodes. Selects on the rest mesh only for forces with an empty box.
std::vector<int> Body::lost_forces(const BodyInputs& inputs, const Selection& selection,
                                   BodyWorkspace& work, std::vector<int> lost) const {
  bool has_rest_tiles = false;
  for (std::size_t k = 0; k < inputs.forces.size(); ++k) {
    const SampledForce& force = inputs.forces[k];
    const ForceSelection& now = selection.forces[k];
    const bool holds_region = force.deformation_radius == 0 || !now.deformation.is_empty();
    const bool holds_load = force.force_radius == 0 || !now.force.is_empty();
    if (holds_region && holds_load) continue;
    if (!has_rest_tiles) work.rest_tiles.update(grid_, {rest_, inputs.transform});
    has_rest_tiles = true;
    if (is_lost(boxes_of(work.rest_tiles, force), now)) lost.push_back(static_cast<int>(k));
  }
  return lost;
}

Result<void> Body::step(const BodyInputs& inputs) {
  if (inputs.forces.empty() && !recovers()) {
    work_.selection = {};
    work_.report = {};
    return {};
  }
  StageTimer planning(profile_, Stage::Selection);
  if (auto planned = plan(inputs, work_); !planned) return planned;
  planning.stop();
  const StepReport& report = work_.report;
  if (!report.is_solved) {
    settle(report.settling);
    return {};
  }
  // Builds the next state beside the current one, which is kept until the next one is complete.
  StageTimer beginning(profile_, Stage::StateOut);
  begin_next(report);
  beginning.stop();
  if (auto solved = solve(inputs); !solved) return solved;
  const StageTimer ending(profile_, Stage::StateOut);
  return take();
}

void Body::settle(const std::vector<int>& nodes) {
  for (const int node : nodes) {
    state_.positions.row(node) = rest_.row(node);
    state_.velocities.row(node).setZero();
    state_.unsettled[static_cast<std::size_t>(node)] = 0;
  }
}

// Nodes that no solve moves: they stay in place or are put at rest, without velocity.
void Body::begin_next(const StepReport& report) {
  const bool settles = !report.settling.empty();
  const Box hole = settles ? Box{} : lone_rectangle(report);
  copy_around(grid_, hole, state_.positions, work_.next_positions);
  clear_around(grid_, hole, work_.next_velocities);
  for (const int node : report.settling) work_.next_positions.row(node) = rest_.row(node);
}

// Destroys the solvers that the frame does not need.
void Body::keep_solvers(const StepReport& report) {
  auto& outlines = work_.outlines;
  std::size_t count = 0;
  bool are_same = true;
  for (const auto& some : report.patches) {
    for (const Patch& patch : some) {
      are_same = are_same && count < outlines.size() && is_outline_of(outlines[count], patch);
      ++count;
    }
  }
  if (are_same && count == outlines.size()) return;
  outlines.clear();
  for (const auto& some : report.patches) {
    for (const Patch& patch : some) {
      const Grid grid{patch.box.columns(), patch.box.rows(), grid_.hu, grid_.hv};
      outlines.emplace_back(grid, patch.interior);
    }
  }
  work_.solves.resize(count);
  solvers_.keep_only(outlines);
}

Result<void> Body::solve(const BodyInputs& inputs) {
  const StepReport& report = work_.report;
  keep_solvers(report);
  const bool from_rest = settings_.reference == Reference::Rest;
  // Nodes that settle are put at rest before the solve.
  const Field& positions = report.settling.empty() ? state_.positions : work_.next_positions;
  const Matrix3d to_object = inverse_linear(inputs.transform);
  std::size_t place = 0;
  for (std::size_t k = 0; k < report.patches.size(); ++k) {
    if (report.patches[k].empty()) continue;
    const Region& region = report.selection.regions[k];
    const double length = recovers() ? settling_length(grid_, rest_, region) : 0;
    for (const Patch& patch : report.patches[k]) {
      BodyWorkspace::PatchSolve& one = work_.solves[place];
      PlateProblem& problem = one.problem;
      const Box& box = patch.box;
      one.patch = &patch;
      one.settling_length = length;
      problem.outline = work_.outlines[place];
      problem.stiffness = inputs.stiffness;
      problem.dynamics = inputs.dynamics;
      problem.tangents = tangents_of(patch, region, inputs.tangents);
      {
        const StageTimer timer(profile_, Stage::Load);
        problem.load = assemble_load(grid_, work_.tiles.nodes(), inputs.forces, report.selection, k,
                                     box, to_object, std::move(problem.load));
      }
      {
        const StageTimer timer(profile_, Stage::StateIn);
        Field& displacement = one.plate.displacement;
        displacement = from_rest
                           ? difference_of(grid_, box, positions, rest_, std::move(displacement))
                           : rows_of(grid_, box, positions, std::move(displacement));
        one.plate.velocity = rows_of(grid_, box, state_.velocities, std::move(one.plate.velocity));
      }
      PlateSolver& solver = solvers_.solver_of(work_.outlines[place]);
      auto next = solver.advance(problem, report.steps, std::move(one.plate));
      if (!next) return fail(next.error());
      one.plate = *std::move(next);
      ++place;
    }
  }
  return {};
}

// Makes the solution the state, all of it or nothing. The rim is not written: rest + (position -
// rest) may round.
Result<void> Body::take() {
  const Field* const reference = settings_.reference == Reference::Rest ? &rest_ : nullptr;
  for (const BodyWorkspace::PatchSolve& one : work_.solves) {
    if (!put_interior(grid_, *one.patch, one.plate.displacement, one.plate.velocity, reference,
                      work_.next_positions, work_.next_velocities)) {
      return fail(ErrorCode::NotFinite, "the state stopped being finite");
    }
  }
  if (recovers()) mark_unsettled();
  state_.positions.swap(work_.next_positions);
  state_.velocities.swap(work_.next_velocities);
  return {};
}

// Requires: the next positions are complete, but not yet in the state.
void Body::mark_unsettled() {
  std::fill(state_.unsettled.begin(), state_.unsettled.end(), std::uint8_t{0});
  for (const BodyWorkspace::PatchSolve& one : work_.solves) {
    const Box& box = one.patch->box;
    for (int j = box.j0 + 1; j < box.j1; ++j) {
      for (int i = box.i0 + 1; i < box.i1; ++i) {
        if (!one.patch->holds(i, j)) continue;
        const int node = grid_.node(i, j);
        const auto position = work_.next_positions.row(node);
        const double displacement = length(position - rest_.row(node));
        const double motion = length(position - state_.positions.row(node));
        const double larger = std::max(displacement, motion);
        state_.unsettled[static_cast<std::size_t>(node)] =
            larger > 0 && larger >= one.settling_length;
      }
    }
  }
}

}  // namespace pliant
