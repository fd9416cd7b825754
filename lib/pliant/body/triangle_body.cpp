#include "pliant/body/triangle_body.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/swing.hpp"
#include "pliant/plate/vibration.hpp"

namespace pliant {
namespace {

std::vector<bool> border_nodes(const TriangleSurface& surface) {
  std::vector<bool> is_border(static_cast<std::size_t>(surface.node_count()));
  for (int face = 0; face < surface.face_count(); ++face) {
    const std::span<const int> nodes = surface.nodes_of(face), edges = surface.edges_of(face);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (surface.edge_sides[edges[k]] != 1) continue;
      is_border[nodes[k]] = is_border[nodes[(k + 1) % nodes.size()]] = true;
    }
  }
  return is_border;
}

SolverChoice factor_of(SolverChoice choice) {
  const bool is_factor = choice != SolverChoice::Auto && choice != SolverChoice::Spectral;
  return is_factor ? choice : available_solvers().front();
}

}  // namespace

Bending bending_of(const BodyInputs& inputs, const std::array<double, 2>& unit, Border border) {
  const bool is_free = border == Border::Free;
  return bending_of(inputs.stiffness, unit, is_free ? std::optional(inputs.poisson) : std::nullopt);
}

std::vector<double> means_on_triangles(const TriangleSurface& surface,
                                       const std::vector<double>& at_nodes) {
  std::vector<double> means;
  if (at_nodes.empty()) return means;
  means.reserve(surface.triangles.size());
  for (int face = 0; face < surface.face_count(); ++face) {
    const std::span<const int> nodes = surface.nodes_of(face);
    double sum = 0;
    for (const int node : nodes) sum += at_nodes[static_cast<std::size_t>(node)];
    if (!surface.has_centre(face)) {
      means.push_back(sum / 3);
      continue;
    }
    const double at_centre = sum / static_cast<double>(nodes.size());
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const int next = nodes[(k + 1) % nodes.size()];
      means.push_back((at_nodes[static_cast<std::size_t>(nodes[k])] +
                       at_nodes[static_cast<std::size_t>(next)] + at_centre) /
                      3);
    }
  }
  return means;
}

std::shared_ptr<const CellFactors> factors_of(const TriangleSurface& surface,
                                              const LevelSet& level_set, const TrianglePatch& patch,
                                              const NodeFactors* factors) {
  if (!factors) return nullptr;
  CellFactors own;
  const auto at_points = [&](const std::vector<double>& at_nodes) {
    std::vector<double> at;
    for (int k = 0; !at_nodes.empty() && k < patch.free_nodes; ++k) {
      const int node = level_set.nodes[static_cast<std::size_t>(patch.points[k])];
      at.push_back(at_nodes[static_cast<std::size_t>(node)]);
    }
    return at;
  };
  const auto at_cells = [&](const std::vector<double>& at_nodes) {
    const std::vector<double> means = means_on_triangles(surface, at_nodes);
    std::vector<double> at;
    for (std::size_t k = 0; !means.empty() && k < patch.cells.cells.size(); ++k)
      at.push_back(means[static_cast<std::size_t>(patch.cells.cells[k].triangle)]);
    return at;
  };
  own.density = at_points(factors->density);
  own.damping = at_points(factors->damping);
  own.b = at_cells(factors->b);
  own.c = at_cells(factors->c);
  own.d = at_cells(factors->d);
  const auto at_triangles = [&](const std::vector<double>& at_nodes) {
    std::vector<double> at;
    const std::vector<double> means = means_on_triangles(surface, at_nodes);
    if (means.empty()) return at;
    for (const int triangle : triangles_of(patch.cells))
      at.push_back(means[static_cast<std::size_t>(triangle)]);
    return at;
  };
  own.yield = at_triangles(factors->yield);
  own.hardening = at_triangles(factors->hardening);
  return std::make_shared<const CellFactors>(std::move(own));
}

TriangleBody::TriangleBody(std::shared_ptr<const TriangleSurface> surface, PointTree tree,
                           const BodySettings& settings, SolverChoice solver, RunContext context,
                           std::shared_ptr<const NodeFactors> factors)
    : Body(surface->rest, static_cast<Eigen::Index>(surface->triangles.size()), settings,
           std::move(factors)),
      surface_(std::move(surface)),
      tree_(std::move(tree)),
      is_border_(border_nodes(*surface_)),
      settling_length_(1e-6 * length_of(surface_->rest.colwise().maxCoeff() -
                                        surface_->rest.colwise().minCoeff())),
      solver_(factor_of(solver)),
      context_(std::move(context)) {
  PLIANT_EXPECTS(settings.reference == Reference::Rest);
}

SolverCounts TriangleBody::solver_counts() const {
  SolverCounts counts = past_counts_;
  for (const PatchSolve& one : solves_) counts = counts + one.plate->counts();
  return counts;
}

Result<StepPlan> TriangleBody::look(const BodyInputs& inputs) const {
  StepPlan next = plan_;  // patches that stay need not be cut out again
  if (auto planned = plan(inputs, next); !planned) return fail(planned.error());
  return next;
}

Result<void> TriangleBody::plan(const BodyInputs& inputs, StepPlan& plan) const {
  PLIANT_EXPECTS(fits(inputs));
  if (!settings_.is_animated) return plan_on(*surface_, tree_, inputs, plan);
  const TriangleSurface moved = posed(*surface_, *inputs.shape);
  const auto tree = PointTree::make(moved.rest, context_.should_stop);
  if (!tree) return fail(tree.error());
  return plan_on(moved, *tree, inputs, plan);
}

// `surface` and `tree` are those at the frame.
Result<void> TriangleBody::plan_on(const TriangleSurface& surface, const PointTree& tree,
                                   const BodyInputs& inputs, StepPlan& plan) const {
  if (!plan.surface) plan.surface.emplace();
  TriangleSelection& selection = *plan.surface;
  plan.steps = steps_of(inputs, settings_, factors_.get());
  plan.is_whole = settings_.region == SolvedRegion::All;
  if (plan.is_whole) {
    if (selection.patches.empty()) {
      if (auto selected = select_all(selection); !selected) return selected;
    }
    return weigh(surface, tree, inputs, selection);
  }
  LevelSet level_set =
      find_level_set(surface, tree, inputs.transform, inputs.forces, inputs.selectors);
  snap(level_set);
  plan.recovering.clear();
  plan.settling.clear();
  if (recovers()) {
    for (int node = 0; node < surface_->node_count(); ++node) {
      if (state_.unsettled[node] && !(level_set.at_node(node) > 0)) plan.recovering.push_back(node);
    }
    if (!plan.recovering.empty()) level_set = with_inside(*surface_, level_set, plan.recovering);
    for (int node = 0; node < surface_->node_count(); ++node) {
      const bool is_at_rest =
          state_.positions.row(node) == rest_.row(node) && state_.velocities.row(node).isZero(0);
      if (!is_at_rest && !(level_set.at_node(node) > 0)) plan.settling.push_back(node);
    }
  }
  if (selection.patches.empty() || !(selection.level_set == level_set)) {
    selection.level_set = std::move(level_set);
    selection.patches.clear();
    auto patches =
        cut_out(*surface_, selection.level_set, is_border_, settings_.border, context_.should_stop);
    if (!patches) return fail(patches.error());
    selection.patches = *std::move(patches);
  }
  return weigh(surface, tree, inputs, selection);
}

// Patches that nothing holds move too.
Result<void> TriangleBody::select_all(TriangleSelection& selection) const {
  std::vector<int> nodes(static_cast<std::size_t>(surface_->node_count()));
  std::iota(nodes.begin(), nodes.end(), 0);
  selection.level_set = with_inside(*surface_, {}, nodes);
  auto patches =
      cut_out(*surface_, selection.level_set, is_border_, settings_.border, context_.should_stop);
  if (!patches) return fail(patches.error());
  selection.patches = *std::move(patches);
  for (TrianglePatch& patch : selection.patches) patch.may_float = true;
  return {};
}

// Computes the loads, and what each force does.
Result<void> TriangleBody::weigh(const TriangleSurface& surface, const PointTree& tree,
                                 const BodyInputs& inputs, TriangleSelection& selection) const {
  Field room;
  const PlacedNodes nodes(measured(inputs, room), inputs.transform, densities());
  const PlacedNodes rest_nodes(surface.rest, inputs.transform, densities());
  for (const int node : selection.level_set.nodes) {
    if (!nodes.at(node).allFinite()) {
      return fail(ErrorCode::NotFinite, "a position in world space is not finite");
    }
  }
  selection.loads.clear();
  for (const TrianglePatch& patch : selection.patches) {
    selection.loads.push_back(Field::Zero(patch.free_nodes, 3));
  }
  selection.forces.assign(inputs.forces.size(), {});
  TriangleLoads loads(selection.level_set, selection.patches, nodes);
  for (std::size_t k = 0; k < inputs.forces.size(); ++k) {
    if (context_.is_stopped()) return interrupted();
    const SampledForce& force = inputs.forces[k];
    TriangleForceSelection& told = selection.forces[k];
    const auto reach = [&](double radius, bool with_faces) {
      return reaches(surface, tree, inputs.transform, force, radius, with_faces);
    };
    told.selects = inputs.selectors.empty() || inputs.selectors[k] == static_cast<int>(k);
    const std::vector<bool> within =
        nodes_within(surface, selection.level_set, inputs.transform, force);
    for (const TrianglePatch& patch : selection.patches) {
      told.counts = told.counts + patch.counts_of(within);
    }
    const double radius = force.deformation_radius;
    told.is_near =
        told.counts.inside_nodes > 0 || (told.selects && radius > 0 && reach(radius, true));
    told.acts_inside = loads.compute(force);
    told.acts_outside = !told.acts_inside && reach(force.force_radius, false);
    if (!told.acts_inside && settings_.measure == Measure::Current) {
      TriangleLoads at_rest(selection.level_set, selection.patches, rest_nodes);
      told.is_lost = at_rest.compute(force);
    }
    for (std::size_t n = 0; n < selection.patches.size(); ++n) {
      if (!selection.patches[n].moves()) continue;
      selection.loads[n] += loads.loads(n);
    }
    told.push = loads.push();
  }
  return {};
}

Result<void> TriangleBody::step(const BodyInputs& inputs) {
  if (inputs.forces.empty() && waits_for_forces()) {
    plan_ = {};
    return {};
  }
  StageTimer planning(context_.profile, Stage::Selection);
  if (auto planned = plan(inputs, plan_); !planned) return planned;
  planning.stop();
  if (!plan_.solves()) {
    put_at_rest(plan_.settling);
    return {};
  }
  // Builds the next state beside the current one, which is kept until the next one is complete.
  next_positions_ = state_.positions;
  for (const int node : plan_.settling) next_positions_.row(node) = rest_.row(node);
  next_velocities_.setZero(rest_.rows(), 3);
  if (remembers_push()) {
    next_push_ = nothing_pushed();
    next_push_.tangents = inputs.tangents;
  }
  keep_plates();
  if (auto solved = solve(inputs); !solved) return solved;
  const StageTimer ending(context_.profile, Stage::StateOut);
  return take();
}

// Makes a plate of each patch that moves; one whose cells are those of an earlier plate keeps it.
void TriangleBody::keep_plates() {
  std::vector<PatchSolve> earlier = std::exchange(solves_, {});
  for (const TrianglePatch& patch : plan_.surface->patches) {
    if (!patch.moves()) continue;
    const auto same = std::find_if(earlier.begin(), earlier.end(), [&](const PatchSolve& one) {
      return one.plate && one.plate->cells() == patch.cells && one.plate->masses() == patch.masses;
    });
    solves_.push_back(same != earlier.end() ? std::move(*same) : PatchSolve{});
  }
  // Plates that are gone make room for new ones.
  for (PatchSolve& one : earlier) {
    if (one.plate) past_counts_ = past_counts_ + one.plate->counts();
    one.plate.reset();
  }
  std::size_t place = 0;
  for (const TrianglePatch& patch : plan_.surface->patches) {
    if (!patch.moves()) continue;
    std::unique_ptr<TrianglePlate>& plate = solves_[place++].plate;
    if (plate) continue;
    plate = std::make_unique<TrianglePlate>(
        patch.cells, patch.masses, solver_, context_,
        factors_of(*surface_, plan_.surface->level_set, patch, factors_.get()));
  }
}

// Those of a patch: with a damping ratio, its slowest vibration decides.
Result<Dynamics> TriangleBody::dynamics_of(const BodyInputs& inputs, const TrianglePatch& patch,
                                           PatchSolve& one) const {
  if (!inputs.asks_for_vibrations()) return inputs.dynamics;
  const StageTimer timer(context_.profile, Stage::SetUp);
  if (!one.lambda || one.bending != one.problem.bending) {
    const auto lambda = smallest_eigenvalue(*one.plate, one.problem.bending, patch.is_held());
    if (!lambda) return fail(lambda.error());
    one.lambda = *lambda;
    one.bending = one.problem.bending;
  }
  return damped_by_ratio(inputs.dynamics, *inputs.damping_ratio, *one.lambda);
}

Result<void> TriangleBody::solve(const BodyInputs& inputs) {
  const TriangleSelection& selection = *plan_.surface;
  const auto slopes_of = [&](const EdgeTangents& tangents) -> std::array<Vector3d, 4> {
    return {tangents.su0 / surface_->unit[0], tangents.su1 / surface_->unit[0],
            tangents.sv0 / surface_->unit[1], tangents.sv1 / surface_->unit[1]};
  };
  std::size_t place = 0;
  for (std::size_t k = 0; k < selection.patches.size(); ++k) {
    const TrianglePatch& patch = selection.patches[k];
    if (!patch.moves()) continue;
    PatchSolve& one = solves_[place++];
    one.problem.bending = bending_of(inputs, surface_->unit, settings_.border);
    const auto dynamics = dynamics_of(inputs, patch, one);
    if (!dynamics) return fail(dynamics.error());
    if (!patch.is_held() && !resists_motion(*dynamics, plan_.steps.solved_length())) {
      return fail(ErrorCode::SolverFailed,
                  "nothing holds the patch with node " +
                      std::to_string(selection.level_set.nodes[patch.points[0]]) +
                      ", which is static: give it a density or a damping");
    }
    one.problem.dynamics = *dynamics;
    one.problem.law = inputs.law;
    one.problem.slopes = slopes_of(inputs.tangents);
    one.problem.load = vectors_to_object(inputs.transform, selection.loads[k]);
    if (remembers_push()) {
      begin_load(patch, one.problem);
      one.problem.first_slopes = slopes_of(first_tangents(inputs.tangents));
    }
    one.state = state_of(patch);
    if (settings_.yields) {
      const std::vector<int>& triangles = one.plate->triangles();
      one.state.plastic.resize(static_cast<Eigen::Index>(triangles.size()), 9);
      for (std::size_t n = 0; n < triangles.size(); ++n)
        one.state.plastic.row(static_cast<Eigen::Index>(n)) = state_.plastic.row(triangles[n]);
    }
    auto next = one.plate->advance(one.problem, plan_.steps, std::move(one.state));
    if (!next) {
      Error error = next.error();
      const int node = selection.level_set.nodes[patch.points[0]];
      if (error.code == ErrorCode::SolverFailed) {
        error.message += ", on the patch with node " + std::to_string(node);
      }
      return fail(std::move(error));
    }
    one.state = *std::move(next);
  }
  return {};
}

// The load that a patch begins with: that of the last solve, at nodes which it moved.
void TriangleBody::begin_load(const TrianglePatch& patch, TriangleProblem& problem) const {
  problem.first_load = problem.load;
  for (int k = 0; k < patch.free_nodes; ++k) {
    const int node = plan_.surface->level_set.nodes[patch.points[k]];
    if (state_.last.unknowns[static_cast<std::size_t>(node)])
      problem.first_load.row(k) = state_.last.loads.row(node);
  }
}

// Displacement and velocity of a patch's points.
TriangleState TriangleBody::state_of(const TrianglePatch& patch) const {
  const LevelSet& level_set = plan_.surface->level_set;
  const auto at_node = [&](int k) -> Eigen::RowVector3d {
    const int node = level_set.nodes[k];
    return next_positions_.row(node) - rest_.row(node);
  };
  // The mean over those corners of a face that are not inside.
  const auto at_centre = [&](int face) -> Eigen::RowVector3d {
    Eigen::RowVector3d sum(0, 0, 0);
    int count = 0;
    for (const int corner : level_set.corners_of(static_cast<std::size_t>(face))) {
      if (level_set.at_nodes[corner] > 0) continue;
      sum += at_node(corner);
      ++count;
    }
    return count > 0 ? Eigen::RowVector3d(sum / count) : sum;
  };
  TriangleState state{Field::Zero(patch.cells.point_count, 3), Field(patch.free_nodes, 3)};
  for (std::size_t k = 0; k < patch.points.size(); ++k) {
    auto row = state.displacement.row(static_cast<Eigen::Index>(k));
    if (patch.points[k] >= 0) {
      row = at_node(patch.points[k]);
      continue;
    }
    const CutPoint& point = patch.cut_points[-1 - patch.points[k]];
    if (point.kind == CutPoint::Kind::Rim) {
      row = point.of[1] >= 0 ? at_node(point.of[1]) : at_centre(-1 - point.of[1]);
    } else if (point.kind == CutPoint::Kind::Centre &&
               static_cast<int>(k) >= patch.cells.free_points) {
      row = at_centre(point.face);
    }
  }
  for (int k = 0; k < patch.free_nodes; ++k) {
    state.velocity.row(k) = state_.velocities.row(level_set.nodes[patch.points[k]]);
  }
  return state;
}

// Makes the solution the state, all of it or nothing.
Result<void> TriangleBody::take() {
  const std::vector<int>& nodes = plan_.surface->level_set.nodes;
  next_plastic_ = state_.plastic;
  std::size_t place = 0;
  for (const TrianglePatch& patch : plan_.surface->patches) {
    if (!patch.moves()) continue;
    const PatchSolve& one = solves_[place++];
    const TriangleState& state = one.state;
    for (Eigen::Index n = 0; n < state.plastic.rows(); ++n)
      next_plastic_.row(one.plate->triangles()[static_cast<std::size_t>(n)]) = state.plastic.row(n);
    for (int k = 0; k < patch.free_nodes; ++k) {
      const int node = nodes[patch.points[k]];
      next_positions_.row(node) = rest_.row(node) + state.displacement.row(k);
      next_velocities_.row(node) = state.velocity.row(k);
      if (!next_positions_.row(node).allFinite() || !next_velocities_.row(node).allFinite()) {
        return fail(ErrorCode::NotFinite, "the state stopped being finite");
      }
      if (!remembers_push()) continue;
      next_push_.loads.row(node) = one.problem.load.row(k);
      next_push_.unknowns[static_cast<std::size_t>(node)] = 1;
    }
  }
  if (!next_plastic_.allFinite())
    return fail(ErrorCode::NotFinite, "the state stopped being finite");
  if (recovers()) mark_unsettled();
  state_.positions.swap(next_positions_);
  state_.velocities.swap(next_velocities_);
  state_.plastic.swap(next_plastic_);
  if (remembers_push()) std::swap(state_.last, next_push_);
  return {};
}

// Requires: the next positions are complete, but not yet in the state.
void TriangleBody::mark_unsettled() {
  std::fill(state_.unsettled.begin(), state_.unsettled.end(), std::uint8_t{0});
  // Those of a patch that nothing holds too: they stay away from rest, and come back once it moves.
  for (const TrianglePatch& patch : plan_.surface->patches) {
    for (int k = 0; k < patch.free_nodes; ++k) {
      const int node = plan_.surface->level_set.nodes[patch.points[k]];
      const auto position = next_positions_.row(node);
      const double larger = std::max(length_of(position - rest_.row(node)),
                                     length_of(position - state_.positions.row(node)));
      state_.unsettled[static_cast<std::size_t>(node)] = larger > 0 && larger >= settling_length_;
    }
  }
}

}  // namespace pliant
