#include "pliant/body/body.hpp"

#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/plate/backward_euler.hpp"

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

// The same rows back in their places.
void replace_rows(const Grid& grid, const Box& box, const Field& part, Field& nodes) {
  for (int component = 0; component < 3; ++component) {
    for (int j = 0; j < box.rows(); ++j) {
      nodes.col(component).segment(grid.node(box.i0, box.j0 + j), box.columns()) =
          part.col(component).segment(Eigen::Index{j} * box.columns(), box.columns());
    }
  }
}

bool is_solvable(const Box& region) { return region.columns() >= 3 && region.rows() >= 3; }

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
    if (!now.deformation.is_empty() && !now.force.is_empty()) continue;
    if (nodes.size() == 0) nodes = to_world(transform, rest);
    const ForceSelection at_rest = select_region(grid, nodes, {&forces[k], 1}).forces.front();
    if (is_lost(at_rest, now)) lost.push_back(static_cast<int>(k));
  }
  return lost;
}

}  // namespace

Body::Body(const Grid& grid, Field rest, const BodySettings& settings, MemoryBudget* budget)
    : grid_(grid),
      rest_(std::move(rest)),
      settings_(settings),
      solver_(make_solver(available_solvers().front(), budget)) {
  PLIANT_EXPECTS(grid_.columns >= 3 && grid_.rows >= 3 && rest_.rows() == grid_.node_count());
  reset();
}

void Body::reset() { state_ = {rest_, Field::Zero(grid_.node_count(), 3)}; }

void Body::restore(BodyState state) {
  PLIANT_EXPECTS(state.positions.rows() == grid_.node_count());
  PLIANT_EXPECTS(state.velocities.rows() == grid_.node_count());
  state_ = std::move(state);
}

Result<StepReport> Body::step(const BodyInputs& inputs, const StopRequest& should_stop) {
  StepReport report;
  if (inputs.forces.empty()) return report;

  const bool measures_rest = settings_.measure == Measure::Rest;
  const Field nodes = to_world(inputs.transform, measures_rest ? rest_ : state_.positions);
  report.selection = select_region(grid_, nodes, inputs.forces);
  if (!measures_rest) {
    report.lost = lost_forces(grid_, inputs.transform, rest_, inputs.forces, report.selection);
  }
  const Box& region = report.selection.region;
  if (!is_solvable(region)) return report;

  const TimeSteps steps = divide_interval(inputs.frame_length, inputs.dt, settings_.stepping);
  const Field load = assemble_load(grid_, nodes, inputs.forces, report.selection);
  const auto solved =
      solve(region, vectors_to_object(inputs.transform, load), inputs, steps, should_stop);
  if (!solved) return fail(solved.error());
  report.is_solved = true;
  report.steps = steps;
  return report;
}

Result<void> Body::solve(const Box& region, const Field& load, const BodyInputs& inputs,
                         const TimeSteps& steps, const StopRequest& should_stop) {
  const bool from_rest = settings_.reference == Reference::Rest;
  const Field reference = rows_of(grid_, region, rest_);
  PlateState plate{rows_of(grid_, region, state_.positions),
                   rows_of(grid_, region, state_.velocities)};
  if (from_rest) plate.displacement -= reference;

  const PlateProblem problem{{region.columns(), region.rows(), grid_.hu, grid_.hv},
                             inputs.stiffness,
                             inputs.dynamics,
                             inputs.tangents,
                             load};
  auto next = advance_backward_euler(*solver_, problem, steps, std::move(plate), should_stop);
  if (!next) return fail(next.error());

  // The rim is put back as it was, not as rest + (position - rest), which may round.
  const Field moved = from_rest ? Field(reference + next->displacement) : next->displacement;
  const Field positions = with_interior(problem.grid, rows_of(grid_, region, state_.positions),
                                        interior_of(problem.grid, moved));
  if (!positions.allFinite() || !next->velocity.allFinite()) {
    return fail(ErrorCode::NotFinite, "the state stopped being finite");
  }
  replace_rows(grid_, region, positions, state_.positions);
  state_.velocities.setZero();
  replace_rows(grid_, region, next->velocity, state_.velocities);
  return {};
}

}  // namespace pliant
