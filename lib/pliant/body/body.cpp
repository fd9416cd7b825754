#include "pliant/body/body.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pliant/body/recovery.hpp"
#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

// The rows of a box out of a field on all nodes.
Field rows_of(const Grid& grid, const Box& box, const Field& nodes) {
  Field part(Eigen::Index{box.columns()} * box.rows(), 3);
  for (int component = 0; component < 3; ++component) {
    for (int j = 0; j < box.rows(); ++j) {
      part.col(component).segment(Eigen::Index{j} * box.columns(), box.columns()) =
          nodes.col(component).segment(grid.node(box.i0, box.j0 + j), box.columns());
    }
  }
  return part;
}

// The interior rows of a patch, numbered row by row, in their places of a field on all nodes.
void replace_interior(const Grid& grid, const Patch& patch, const Field& part, Field& nodes) {
  const Box& box = patch.box;
  const int width = box.columns() - 2;
  for (int component = 0; component < 3; ++component) {
    Eigen::Index row = 0;
    for (int j = box.j0 + 1; j < box.j1; ++j) {
      if (patch.is_rectangle()) {
        nodes.col(component).segment(grid.node(box.i0 + 1, j), width) =
            part.col(component).segment(row, width);
        row += width;
        continue;
      }
      for (int i = box.i0 + 1; i < box.i1; ++i) {
        if (patch.holds(i, j)) nodes(grid.node(i, j), component) = part(row++, component);
      }
    }
  }
}

double length(const Eigen::RowVector3d& a) {
  return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

// Tangents belong to the sides that lie at the ends of the whole region; SPEC 5.
EdgeTangents tangents_of(const Patch& patch, const Region& region, EdgeTangents tangents) {
  if (patch.box.i0 != region.box.i0) tangents.su0.setZero();
  if (patch.box.i1 != region.box.i1) tangents.su1.setZero();
  if (patch.box.j0 != region.box.j0) tangents.sv0.setZero();
  if (patch.box.j1 != region.box.j1) tangents.sv1.setZero();
  return tangents;
}

std::vector<Patch> all_of(const std::vector<std::vector<Patch>>& patches) {
  std::vector<Patch> all;
  for (const auto& some : patches) all.insert(all.end(), some.begin(), some.end());
  return all;
}

std::vector<std::vector<Patch>> patches_of(const Selection& selection) {
  std::vector<std::vector<Patch>> patches;
  for (const Region& region : selection.regions) patches.push_back(patches_of(region));
  return patches;
}

// Whether a force holds nodes at rest, to deform or to push, that it does not hold as things stand.
bool is_lost(const ForceSelection& at_rest, const ForceSelection& now) {
  return (now.deformation.is_empty() && !at_rest.deformation.is_empty()) ||
         (now.force.is_empty() && !at_rest.force.is_empty());
}

// The forces that lost their nodes. Selects on the rest mesh only for those that hold none.
std::vector<int> lost_forces(const Grid& grid, const Transform& transform, const Field& rest,
                             const std::vector<SampledForce>& forces, const Selection& selection) {
  std::vector<int> lost;
  Field nodes;
  for (std::size_t k = 0; k < forces.size(); ++k) {
    const ForceSelection& now = selection.forces[k];
    const bool holds_region = forces[k].deformation_radius == 0 || !now.deformation.is_empty();
    const bool holds_load = forces[k].force_radius == 0 || !now.force.is_empty();
    if (holds_region && holds_load) continue;
    if (nodes.size() == 0) nodes = to_world(transform, rest);
    const ForceSelection at_rest = select_region(grid, nodes, {&forces[k], 1}).forces.front();
    if (is_lost(at_rest, now)) lost.push_back(static_cast<int>(k));
  }
  return lost;
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

Body::Body(const Grid& grid, Field rest, const BodySettings& settings, SolverCache solvers)
    : grid_(grid), rest_(std::move(rest)), settings_(settings), solvers_(std::move(solvers)) {
  PLIANT_EXPECTS(grid_.columns >= 3 && grid_.rows >= 3 && rest_.rows() == grid_.node_count());
  reset();
}

void Body::reset() {
  state_ = {rest_, Field::Zero(grid_.node_count(), 3)};
  if (recovers()) state_.unsettled.assign(static_cast<std::size_t>(grid_.node_count()), 0);
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
  return plan(inputs, measured_nodes(inputs.transform));
}

Result<StepReport> Body::plan(const BodyInputs& inputs, const Field& nodes) const {
  if (!nodes.allFinite()) {
    return fail(ErrorCode::NotFinite, "a position in world space is not finite");
  }
  StepReport report;
  report.steps = divide_interval(inputs.frame_length, inputs.dt, settings_.stepping);
  report.selection =
      select_region(grid_, nodes, inputs.forces, settings_.combine, inputs.selectors);
  if (settings_.measure == Measure::Current) {
    report.lost = lost_forces(grid_, inputs.transform, rest_, inputs.forces, report.selection);
  }
  report.patches = patches_of(report.selection);
  if (recovers()) {
    const Recovering recovering = recovering_nodes(grid_, state_.unsettled, all_of(report.patches));
    if (recovering.node_count > 0) {
      report.selection =
          recombined(std::move(report.selection), settings_.combine, recovering.boxes);
      report.patches = patches_of(report.selection);
      report.recovering = recovering.node_count;
    }
  }
  if (recovers()) {
    report.settling =
        settling_nodes(grid_, rest_, state_.positions, state_.velocities, all_of(report.patches));
  }
  report.is_solved = report.unknown_count() > 0;
  for (std::size_t k = 0; k < inputs.forces.size(); ++k) {
    report.pushing.push_back(pushes(grid_, nodes, inputs.forces[k],
                                    report.selection.forces[k].force, report.patches_of_force(k)));
  }
  return report;
}

Result<StepReport> Body::step(const BodyInputs& inputs, const StopRequest& should_stop) {
  if (inputs.forces.empty() && !recovers()) return StepReport{};
  const Field nodes = measured_nodes(inputs.transform);
  auto report = plan(inputs, nodes);
  if (!report) return report;

  std::optional<BodyState> before;
  if (!report->settling.empty()) before = state_;
  settle(report->settling);
  if (!report->is_solved) return report;
  const auto moved = solve(inputs, nodes, *report, should_stop);
  if (!moved) {
    if (before) state_ = *std::move(before);
    return fail(moved.error());
  }
  take(*moved);
  return report;
}

void Body::settle(const std::vector<int>& nodes) {
  for (const int node : nodes) {
    state_.positions.row(node) = rest_.row(node);
    state_.velocities.row(node).setZero();
    state_.unsettled[static_cast<std::size_t>(node)] = 0;
  }
}

Result<std::vector<Body::Moved>> Body::solve(const BodyInputs& inputs, const Field& nodes,
                                             const StepReport& report,
                                             const StopRequest& should_stop) {
  std::vector<SolverCache::Outline> outlines;
  for (const auto& patches : report.patches) {
    for (const Patch& patch : patches) {
      outlines.push_back({patch.box.columns(), patch.box.rows(), patch.interior});
    }
  }
  solvers_.keep_only(outlines);

  std::vector<Moved> moved;
  for (std::size_t k = 0; k < report.patches.size(); ++k) {
    if (report.patches[k].empty()) continue;
    const Region& region = report.selection.regions[k];
    const Field load = vectors_to_object(
        inputs.transform, assemble_load(grid_, nodes, inputs.forces, report.selection, k));
    const double length = recovers() ? settling_length(grid_, rest_, region) : 0;
    for (const Patch& patch : report.patches[k]) {
      auto one = solve(patch, region, load, inputs, report.steps, should_stop);
      if (!one) return fail(one.error());
      one->settling_length = length;
      moved.push_back(*std::move(one));
    }
  }
  return moved;
}

Result<Body::Moved> Body::solve(const Patch& patch, const Region& region, const Field& load,
                                const BodyInputs& inputs, const TimeSteps& steps,
                                const StopRequest& should_stop) {
  const Box& box = patch.box;
  const bool from_rest = settings_.reference == Reference::Rest;
  const Field reference = rows_of(grid_, box, rest_);
  PlateState plate{rows_of(grid_, box, state_.positions), rows_of(grid_, box, state_.velocities)};
  if (from_rest) plate.displacement -= reference;

  const Grid load_grid{region.box.columns(), region.box.rows(), grid_.hu, grid_.hv};
  const Box place{box.i0 - region.box.i0, box.i1 - region.box.i0, box.j0 - region.box.j0,
                  box.j1 - region.box.j0};
  const PlateProblem problem{{box.columns(), box.rows(), grid_.hu, grid_.hv},
                             inputs.stiffness,
                             inputs.dynamics,
                             tangents_of(patch, region, inputs.tangents),
                             rows_of(load_grid, place, load),
                             patch.interior};
  PlateSolver& solver = solvers_.solver_of({box.columns(), box.rows(), patch.interior});
  auto next = solver.advance(problem, steps, std::move(plate), should_stop);
  if (!next) return fail(next.error());

  // The rim stays as it was: rest + (position - rest) may round.
  const Field moved = from_rest ? Field(reference + next->displacement) : next->displacement;
  Moved result{&patch, interior_of(problem.grid, patch.interior, moved),
               interior_of(problem.grid, patch.interior, next->velocity)};
  if (!result.positions.allFinite() || !result.velocities.allFinite()) {
    return fail(ErrorCode::NotFinite, "the state stopped being finite");
  }
  return result;
}

void Body::take(const std::vector<Moved>& moved) {
  if (recovers()) mark_unsettled(moved);
  state_.velocities.setZero();
  for (const Moved& one : moved) {
    replace_interior(grid_, *one.patch, one.positions, state_.positions);
    replace_interior(grid_, *one.patch, one.velocities, state_.velocities);
  }
}

// Requires: `moved` is not yet in the state.
void Body::mark_unsettled(const std::vector<Moved>& moved) {
  std::fill(state_.unsettled.begin(), state_.unsettled.end(), std::uint8_t{0});
  for (const Moved& one : moved) {
    Eigen::Index row = 0;
    const Box& box = one.patch->box;
    for (int j = box.j0 + 1; j < box.j1; ++j) {
      for (int i = box.i0 + 1; i < box.i1; ++i) {
        if (!one.patch->holds(i, j)) continue;
        const int node = grid_.node(i, j);
        const double displacement = length(one.positions.row(row) - rest_.row(node));
        const double motion = length(one.positions.row(row) - state_.positions.row(node));
        const double larger = std::max(displacement, motion);
        state_.unsettled[static_cast<std::size_t>(node)] =
            larger > 0 && larger >= one.settling_length;
        ++row;
      }
    }
  }
}

}  // namespace pliant
