#include "pliant/body/triangle_body.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "pliant/body/patch_plate.hpp"
#include "pliant/core/expects.hpp"
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

bool are_beyond_line(const Field& rest, const std::vector<int>& nodes) {
  constexpr double rounding = 1e-9;
  if (nodes.empty()) return false;
  const Vector3d first = rest.row(nodes.front()).transpose();
  Vector3d along(0, 0, 0);
  for (const int node : nodes) {
    const Vector3d way = rest.row(node).transpose() - first;
    if (length_of(way) > length_of(along)) along = way;
  }
  const double length = length_of(along);
  if (!(length > 0)) return false;
  along /= length;
  return std::ranges::any_of(nodes, [&](int node) {
    const Vector3d way = rest.row(node).transpose() - first;
    return length_of(way - along.dot(way) * along) > rounding * length;
  });
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

namespace {

// The factors of a patch's plate. Null: the material is even.
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
  own.goal = at_points(factors->goal);
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

class TrianglePatchPlate final : public PatchPlate {
 public:
  TrianglePatchPlate(std::unique_ptr<TrianglePlate> plate, const Bending& bending, double goal,
                     bool is_held)
      : plate_(std::move(plate)), bending_(bending), goal_(goal), is_held_(is_held) {}

  Result<VibratingPlate> vibrating() override {
    return pliant::vibrating(*plate_, bending_, 0, goal_);
  }
  Result<double> smallest_eigenvalue() override {
    return pliant::smallest_eigenvalue(*plate_, bending_, is_held_, goal_);
  }
  std::size_t memory() const override { return plate_->memory(); }

 private:
  std::unique_ptr<TrianglePlate> plate_;
  Bending bending_;
  double goal_;
  bool is_held_;
};

}  // namespace

TriangleBody::TriangleBody(std::shared_ptr<const TriangleSurface> surface,
                           std::shared_ptr<const PointTree> tree, const BodySettings& settings,
                           SolverChoice solver, RunContext context,
                           std::shared_ptr<const NodeFactors> factors,
                           std::shared_ptr<const NodeMarks> held)
    : ElasticBody(surface->rest, static_cast<Eigen::Index>(surface->triangles.size()), settings,
                  std::move(context), std::move(factors), std::move(held), surface),
      surface_(std::move(surface)),
      tree_(std::move(tree)),
      is_border_(border_nodes(*surface_)),
      settling_length_(1e-6 * length_of(surface_->rest.colwise().maxCoeff() -
                                        surface_->rest.colwise().minCoeff())),
      solver_(factor_of(solver)) {
  PLIANT_EXPECTS(settings.reference == Reference::Rest);
}

SolverCounts TriangleBody::solver_counts() const {
  SolverCounts counts = past_counts_;
  for (const Solve& one : solves_)
    if (one.plate) counts = counts + one.plate->counts();
  return counts;
}

std::vector<MovedPatch> TriangleBody::moved_patches(const StepPlan& plan,
                                                    std::size_t region) const {
  const TrianglePatch& patch = plan.surface->patches[region];
  MovedPatch moved;
  for (int k = 0; k < patch.free_nodes; ++k)
    moved.nodes.push_back(plan.surface->level_set.nodes[patch.points[k]]);
  return {std::move(moved)};
}

std::unique_ptr<PatchPlate> TriangleBody::plate_of(const BodyInputs& inputs, const StepPlan& plan,
                                                   std::size_t region, std::size_t) const {
  return std::make_unique<TrianglePatchPlate>(
      make_plate(*plan.surface, region, available_solvers().front()),
      bending_of(inputs, surface_->unit, settings_.border), inputs.goal,
      plan.surface->patches[region].is_held());
}

// Patches that stay need not be cut out again.
Result<StepPlan> TriangleBody::look_again(const BodyInputs& inputs, StepPlan&& earlier) const {
  if (auto planned = plan(inputs, earlier); !planned) return fail(planned.error());
  return earlier;
}

Result<void> TriangleBody::plan(const BodyInputs& inputs, StepPlan& plan) const {
  PLIANT_EXPECTS(fits(inputs));
  if (!settings_.is_animated) return plan_on(*surface_, *tree_, inputs, plan);
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
    find_what_holds(inputs, selection);
    return weigh(surface, tree, inputs, selection);
  }
  std::optional<ContactPlaces> places;
  if (inputs.selects_by_colliders()) places.emplace(inputs, rest_at(inputs), plan.steps.count);
  std::vector<NodeDepth> others;
  for (std::size_t k = 0; places && k < inputs.colliders.size(); ++k) {
    others.emplace_back([depths = places->depths(k, state_.positions - rest_)](int node) {
      return depths[static_cast<std::size_t>(node)];
    });
  }
  LevelSet level_set =
      find_level_set(surface, tree, inputs.transform, inputs.forces, inputs.selectors, others);
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
    auto patches = cut_out(*surface_, selection.level_set, is_border_, settings_.border,
                           context_.should_stop, held());
    if (!patches) return fail(patches.error());
    selection.patches = *std::move(patches);
  }
  find_what_holds(inputs, selection);
  return weigh(surface, tree, inputs, selection);
}

// Patches that nothing else holds move if a node of theirs is held or pulled back by a goal, and
// stay in place if such nodes are beyond one line.
void TriangleBody::find_what_holds(const BodyInputs& inputs, TriangleSelection& selection) const {
  const LevelSet& level_set = selection.level_set;
  for (TrianglePatch& patch : selection.patches) {
    patch.is_held_within = false;
    patch.has_rim = true;
    patch.may_float = settings_.region == SolvedRegion::All;
    std::vector<int> nodes;  // that are held or pulled back
    if (held_) {
      patch.has_rim = false;
      for (int k = patch.cells.free_points; k < patch.cells.point_count; ++k) {
        const int point = patch.points[static_cast<std::size_t>(k)];
        const int node = point >= 0 ? level_set.nodes[point] : -1;
        const bool is_within = node >= 0 && (*held_)[node] != 0 && level_set.at_nodes[point] > 0 &&
                               (settings_.border == Border::Free || !is_border_[node]);
        if (is_within) nodes.push_back(node);
        patch.has_rim = patch.has_rim || !is_within;
      }
    }
    if (patch.is_held() || (inputs.goal == 0 && nodes.empty())) continue;
    for (int k = 0; inputs.goal > 0 && k < patch.free_nodes; ++k) {
      const int node = level_set.nodes[patch.points[k]];
      if (!factors_ || factor_at(factors_->goal, node) > 0) nodes.push_back(node);
    }
    patch.may_float = patch.may_float || !nodes.empty();
    patch.is_held_within = are_beyond_line(surface_->rest, nodes);
  }
}

Result<void> TriangleBody::select_all(TriangleSelection& selection) const {
  std::vector<int> nodes(static_cast<std::size_t>(surface_->node_count()));
  std::iota(nodes.begin(), nodes.end(), 0);
  selection.level_set = with_inside(*surface_, {}, nodes);
  auto patches = cut_out(*surface_, selection.level_set, is_border_, settings_.border,
                         context_.should_stop, held());
  if (!patches) return fail(patches.error());
  selection.patches = *std::move(patches);
  return {};
}

// Computes the loads, and what each force does.
Result<void> TriangleBody::weigh(const TriangleSurface& surface, const PointTree& tree,
                                 const BodyInputs& inputs, TriangleSelection& selection) const {
  Field room;
  const PlacedNodes nodes = placed(measured(inputs, room), inputs);
  const PlacedNodes rest_nodes = placed(surface.rest, inputs);
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

// A patch that moves has a plate; if its cells are those of an earlier plate, it keeps that one.
void TriangleBody::keep_patches(const BodyInputs&) {
  std::vector<Solve> earlier = std::exchange(solves_, {});
  const TriangleSelection& selection = *plan_.surface;
  for (const TrianglePatch& patch : selection.patches) {
    const auto same = std::find_if(earlier.begin(), earlier.end(), [&](const Solve& one) {
      return patch.moves() && one.plate && one.plate->cells() == patch.cells &&
             one.plate->masses() == patch.masses;
    });
    solves_.push_back(same != earlier.end() ? std::move(*same) : Solve{});
  }
  // Plates that are gone make room for new ones.
  for (Solve& one : earlier) {
    if (one.plate) past_counts_ = past_counts_ + one.plate->counts();
    one.plate.reset();
  }
  for (std::size_t k = 0; k < solves_.size(); ++k) {
    const TrianglePatch& patch = selection.patches[k];
    Solve& one = solves_[k];
    one.patch = &patch;
    one.region = static_cast<int>(k);
    one.moves = patch.moves();
    one.is_held = patch.is_held();
    one.settling_length = settling_length_;
    if (one.moves && !one.plate) one.plate = make_plate(selection, k, solver_);
    find_rows(one);
  }
}

std::unique_ptr<TrianglePlate> TriangleBody::make_plate(const TriangleSelection& selection,
                                                        std::size_t k, SolverChoice solver) const {
  const TrianglePatch& patch = selection.patches[k];
  return std::make_unique<TrianglePlate>(
      patch.cells, patch.masses, solver, context_,
      factors_of(*surface_, selection.level_set, patch, factors_.get()));
}

void TriangleBody::find_rows(Solve& one) const {
  one.moved.clear();
  for (int k = 0; k < one.patch->free_nodes; ++k)
    add_row(one.moved, plan_.surface->level_set.nodes[one.patch->points[k]], k);
  one.nodes = one.moved;
  one.rows = one.patch->free_nodes;
  one.plastic.clear();
  if (!settings_.yields || !one.plate) return;
  const std::vector<int>& triangles = one.plate->triangles();
  for (std::size_t k = 0; k < triangles.size(); ++k)
    add_row(one.plastic, triangles[k], static_cast<int>(k));
  one.plastic_rows = static_cast<Eigen::Index>(triangles.size());
}

int TriangleBody::first_node(std::size_t k) const {
  return plan_.surface->level_set.nodes[solves_[k].patch->points[0]];
}

std::string TriangleBody::not_held(std::size_t k) const {
  return "nothing holds the patch with node " + std::to_string(first_node(k)) +
         ", which is static: give it a density, a damping or a goal";
}

void TriangleBody::take_material(const BodyInputs& inputs, std::size_t k) {
  solves_[k].problem.bending = bending_of(inputs, surface_->unit, settings_.border);
  solves_[k].problem.goal = inputs.goal;
}

Result<double> TriangleBody::smallest_eigenvalue_of(std::size_t k) {
  Solve& one = solves_[k];
  const auto& [bending, goal] = std::tie(one.problem.bending, one.problem.goal);
  if (!one.lambda || one.bending != bending || one.goal != goal) {
    auto lambda = smallest_eigenvalue(*one.plate, bending, one.is_held, goal);
    if (!lambda) return lambda;
    one.lambda = *lambda;
    one.bending = bending;
    one.goal = goal;
  }
  return *one.lambda;
}

EdgeTangents TriangleBody::tangents_of(const EdgeTangents& tangents, std::size_t) const {
  return {tangents.su0 / surface_->unit[0], tangents.su1 / surface_->unit[0],
          tangents.sv0 / surface_->unit[1], tangents.sv1 / surface_->unit[1]};
}

void TriangleBody::find_load(const BodyInputs& inputs, std::size_t k) {
  solves_[k].problem.load = vectors_to_object(inputs.transform, plan_.surface->loads[k]);
}

Result<void> TriangleBody::advance(std::size_t k) {
  Solve& one = solves_[k];
  auto next = one.plate->advance(one.problem, plan_.steps, std::move(one.state));
  if (next) {
    one.state = *std::move(next);
    return {};
  }
  Error error = next.error();
  if (error.code == ErrorCode::SolverFailed)
    error.message += ", on the patch with node " + std::to_string(first_node(k));
  return fail(std::move(error));
}

// That of the patch's points.
void TriangleBody::find_displacement(std::size_t k) {
  Solve& one = solves_[k];
  const TrianglePatch& patch = *one.patch;
  const Field& positions = first_positions();
  const LevelSet& level_set = plan_.surface->level_set;
  const auto at_node = [&](int number) -> Eigen::RowVector3d {
    const int node = level_set.nodes[number];
    return positions.row(node) - rest_.row(node);
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
  one.state.displacement.setZero(patch.cells.point_count, 3);
  for (std::size_t n = 0; n < patch.points.size(); ++n) {
    auto row = one.state.displacement.row(static_cast<Eigen::Index>(n));
    if (patch.points[n] >= 0) {
      row = at_node(patch.points[n]);
      continue;
    }
    const CutPoint& point = patch.cut_points[-1 - patch.points[n]];
    if (point.kind == CutPoint::Kind::Rim) {
      row = point.of[1] >= 0 ? at_node(point.of[1]) : at_centre(-1 - point.of[1]);
    } else if (point.kind == CutPoint::Kind::Centre &&
               static_cast<int>(n) >= patch.cells.free_points) {
      row = at_centre(point.face);
    }
  }
}

}  // namespace pliant
