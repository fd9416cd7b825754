#include "pliant/body/grid_body.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "pliant/body/patch_plate.hpp"
#include "pliant/body/recovery.hpp"
#include "pliant/core/expects.hpp"
#include "pliant/region/closed_boxes.hpp"
#include "pliant/region/region.hpp"

namespace pliant {
namespace {

// Whether a force has a box on the rest mesh, deformation or force box, that is empty now.
bool is_lost(const ForceSelection& at_rest, const ForceSelection& now) {
  return (now.deformation.is_empty() && !at_rest.deformation.is_empty()) ||
         (now.force.is_empty() && !at_rest.force.is_empty());
}

bool is_outline_of(const Outline& outline, const Patch& patch) {
  const Grid& grid = outline.grid();
  return grid == patch.grid(grid) && outline.mask() == patch.interior &&
         outline.has_held_nodes() == patch.has_held_nodes &&
         outline.edges() == Outline(grid, patch.edges).edges();
}

// A patch with a mask has clamped edges, unless the mask lacks nodes that are held.
Outline outline_of(const Grid& grid, const Patch& patch) {
  if (patch.has_held_nodes) return {patch.grid(grid), patch.edges, patch.interior};
  if (!patch.interior.empty()) return {patch.grid(grid), patch.interior};
  return {patch.grid(grid), patch.edges};
}

// The factors of the grid's nodes on those of a patch's box, in their order. Null stays null.
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
  const auto& [density, damping, b, c, d, yield, hardening, goal] = *factors;
  NodeFactors part{part_of(density), part_of(damping), part_of(b),         part_of(c),
                   part_of(d),       part_of(yield),   part_of(hardening), part_of(goal)};
  return std::make_shared<const NodeFactors>(std::move(part));
}

// Poisson's ratio of a patch's plate: 0 where it has no effect.
double poisson_of(const BodyInputs& inputs, const Patch& patch, const NodeFactors* factors) {
  const bool acts = patch.edges.have_free() || (factors && factors->have_stiffness()) || inputs.law;
  return acts ? inputs.poisson : 0;
}

class GridPatchPlate final : public PatchPlate {
 public:
  GridPatchPlate(PlateSystem system, const RunContext& context)
      : system_(std::move(system)), solver_(make_plate_solver(SolverChoice::Auto, context)) {}

  Result<VibratingPlate> vibrating() override { return pliant::vibrating(*solver_, system_); }
  Result<double> smallest_eigenvalue() override {
    return pliant::smallest_eigenvalue(*solver_, system_);
  }
  std::size_t memory() const override { return solver_->memory(); }

 private:
  PlateSystem system_;
  std::unique_ptr<PlateSolver> solver_;
};

}  // namespace

GridBody::GridBody(const Grid& grid, Field rest, const BodySettings& settings, SolverChoice solver,
                   RunContext context, std::shared_ptr<const NodeFactors> factors,
                   std::shared_ptr<const NodeMarks> held, std::shared_ptr<const NodeFaces> faces)
    : ElasticBody(std::move(rest), grid.node_count(), settings, std::move(context),
                  std::move(factors), std::move(held), std::move(faces)),
      grid_(grid),
      solvers_(solver, context_) {
  PLIANT_EXPECTS(grid_.columns >= 3 && grid_.rows >= 3 && rest_.rows() == grid_.node_count());
}

Result<StepPlan> GridBody::look(const BodyInputs& inputs) const {
  Room room;
  StepPlan next;
  if (auto planned = plan(inputs, room, next); !planned) return fail(planned.error());
  return next;
}

Push GridBody::push_of(const BodyInputs& inputs, const StepPlan& plan, std::size_t force) const {
  Field room;
  return pliant::push_of(grid_, placed(measured(inputs, room), inputs), inputs.forces[force],
                         plan.selection.forces[force].force,
                         plan.selection.patches_of_force(force));
}

std::vector<MovedPatch> GridBody::moved_patches(const StepPlan& plan, std::size_t region) const {
  std::vector<MovedPatch> all;
  for (const Patch& patch : plan.selection.regions[region].patches) {
    MovedPatch& moved = all.emplace_back();
    moved.is_rectangle = patch.is_rectangle();
    const Box& box = patch.box;
    outline_of(grid_, patch).for_each_run([&](const Outline::Run& run) {
      for (int i = run.i0; i <= run.i1; ++i)
        moved.nodes.push_back(grid_.node_round(box.i0 + i, box.j0 + run.j));
    });
  }
  return all;
}

std::unique_ptr<PatchPlate> GridBody::plate_of(const BodyInputs& inputs, const StepPlan& plan,
                                               std::size_t region, std::size_t patch) const {
  const Patch& one = plan.selection.regions[region].patches[patch];
  PlateSystem system{outline_of(grid_, one), inputs.stiffness, 0};
  system.poisson = poisson_of(inputs, one, factors_.get());
  system.factors = factors_on(grid_, one, factors_);
  system.goal = inputs.goal;
  return std::make_unique<GridPatchPlate>(std::move(system), context_);
}

Result<void> GridBody::plan(const BodyInputs& inputs, Room& room, StepPlan& plan) const {
  Selection& selection = plan.selection;
  PLIANT_EXPECTS(fits(inputs));
  room.tiles.update(grid_, placed(measured(inputs, room.measured), inputs));
  if (!room.tiles.are_finite()) {
    return fail(ErrorCode::NotFinite, "a position in world space is not finite");
  }
  plan.steps = steps_of(inputs, settings_, factors_.get());
  plan.is_whole = settings_.region == SolvedRegion::All;
  std::vector<Box> others;
  if (plan.is_whole) {
    others.push_back(grid_.box());
  } else if (inputs.selects_by_colliders()) {
    find_met(inputs, plan, others);
  }
  selection = reselected(std::move(selection), room.tiles, inputs.forces, settings_.combine,
                         inputs.selectors, others);
  if (plan.is_whole) {
    for (Patch& patch : selection.regions[0].patches) patch.edges = settings_.edges;
  }
  for (Region& region : selection.regions) hold_nodes(inputs, region);
  if (settings_.measure == Measure::Current) find_lost(inputs, room, selection);
  if (recovers()) {
    plan.recovering = recovering_nodes(grid_, state_.unsettled, selection.regions, room.marks,
                                       std::move(plan.recovering));
    if (!plan.recovering.empty()) {
      selection =
          recombined(std::move(selection), settings_.combine, boxes_around(grid_, plan.recovering));
      for (Region& region : selection.regions) hold_nodes(inputs, region);
    }
    plan.settling = settling_nodes(grid_, rest_, state_.positions, state_.velocities,
                                   selection.regions, room.marks, std::move(plan.settling));
  }
  for (std::size_t k = 0; k < inputs.forces.size(); ++k) {
    ForceSelection& force = selection.forces[k];
    force.pushes = pushes(grid_, room.tiles.nodes(), inputs.forces[k], force.force,
                          selection.patches_of_force(k));
  }
  return {};
}

// Adds the box of the nodes that each collider selects, on the current mesh.
void GridBody::find_met(const BodyInputs& inputs, const StepPlan& plan,
                        std::vector<Box>& boxes) const {
  const ContactPlaces places(inputs, rest_at(inputs), plan.steps.count);
  const Field displacement = state_.positions - rest_;
  for (std::size_t c = 0; c < inputs.colliders.size(); ++c) {
    const std::vector<double> depths = places.depths(c, displacement);
    LineMarks lines(grid_);
    Box box;
    for (int j = 0; j < grid_.rows; ++j) {
      for (int i = 0; i < grid_.columns; ++i) {
        const int node = grid_.node(i, j);
        if (!(depths[static_cast<std::size_t>(node)] > 0)) continue;
        box.include(i, j);
        if (!grid_.is_open()) lines.include(i, j);
      }
    }
    if (!box.is_empty()) boxes.push_back(grid_.is_open() ? box : lines.box());
  }
}

// Takes nodes that are held out of the patches of a region, which are rectangles or rings then, and
// patches of which all are held out of it. Finds what goals and such nodes hold.
void GridBody::hold_nodes(const BodyInputs& inputs, Region& region) const {
  const auto all_held = [&](Patch& patch) {
    if (!held_ || (!patch.interior.empty() && !patch.has_held_nodes)) return false;
    const Box& box = patch.box;
    const Box inner = patch.inner();
    patch.has_held_nodes = false;
    patch.interior.assign(std::size_t(box.columns()) * std::size_t(box.rows()), 0);
    int left = 0;
    for (int j = inner.j0; j <= inner.j1; ++j) {
      for (int i = inner.i0; i <= inner.i1; ++i) {
        const bool is_held = (*held_)[static_cast<std::size_t>(grid_.node_round(i, j))] != 0;
        patch.has_held_nodes = patch.has_held_nodes || is_held;
        if (is_held) continue;
        patch.interior[std::size_t(j - box.j0) * std::size_t(box.columns()) +
                       std::size_t(i - box.i0)] = 1;
        ++left;
      }
    }
    if (!patch.has_held_nodes) patch.interior.clear();
    return left == 0;
  };
  std::erase_if(region.patches, all_held);
  for (Patch& patch : region.patches) {
    patch.is_held_within = false;
    if ((inputs.goal > 0 || patch.has_held_nodes) && !patch.is_held())
      patch.is_held_within = is_held_within(inputs, patch);
  }
}

// Whether held nodes or a goal hold a patch that its edges do not.
bool GridBody::is_held_within(const BodyInputs& inputs, const Patch& patch) const {
  PlateSystem system{outline_of(grid_, patch), inputs.stiffness};
  system.factors = factors_on(grid_, patch, factors_);
  system.goal = inputs.goal;
  return pliant::is_held(system);
}

// Finds the forces that lost their nodes. Selects on the rest mesh only for forces with an empty
// box.
void GridBody::find_lost(const BodyInputs& inputs, Room& room, Selection& selection) const {
  bool has_rest_tiles = false;
  for (std::size_t k = 0; k < inputs.forces.size(); ++k) {
    const SampledForce& force = inputs.forces[k];
    ForceSelection& now = selection.forces[k];
    const bool holds_region = force.deformation_radius == 0 || !now.deformation.is_empty();
    const bool holds_load = force.force_radius == 0 || !now.force.is_empty();
    if (holds_region && holds_load) continue;
    if (!has_rest_tiles) room.rest_tiles.update(grid_, {rest_at(inputs), inputs.transform});
    has_rest_tiles = true;
    now.is_lost = is_lost(boxes_of(room.rest_tiles, force), now);
  }
}

void GridBody::keep_patches(const BodyInputs& inputs) {
  keep_outlines();
  std::size_t place = 0;
  const std::vector<Region>& regions = plan_.selection.regions;
  for (std::size_t k = 0; k < regions.size(); ++k) {
    if (!regions[k].is_solved()) continue;
    const double length = recovers() ? settling_length(grid_, rest_at(inputs), regions[k]) : 0;
    for (const Patch& patch : regions[k].patches) {
      Solve& one = solves_[place++];
      one.patch = &patch;
      one.region = static_cast<int>(k);
      one.is_held = patch.is_held();
      one.settling_length = length;
      find_rows(one);
    }
  }
}

// Destroys the solvers that the frame does not need.
void GridBody::keep_outlines() {
  const std::vector<Region>& regions = plan_.selection.regions;
  std::size_t count = 0;
  bool are_same = true;
  for (const Region& region : regions) {
    for (const Patch& patch : region.patches) {
      are_same = are_same && count < solves_.size() &&
                 is_outline_of(solves_[count].problem.outline, patch);
      ++count;
    }
  }
  if (are_same && count == solves_.size()) return;
  std::vector<Outline> outlines;
  for (const Region& region : regions) {
    for (const Patch& patch : region.patches) outlines.push_back(outline_of(grid_, patch));
  }
  solvers_.keep_only(outlines);
  solves_.resize(count);
  for (std::size_t k = 0; k < count; ++k) solves_[k].problem.outline = std::move(outlines[k]);
}

void GridBody::find_rows(Solve& one) const {
  const Box& box = one.patch->box;
  const auto add = [&](std::vector<RowRun>& runs, int i0, int i1, int j) {
    const int row = (j - box.j0) * box.columns() + (i0 - box.i0);
    for_each_stretch(grid_, i0, i1, j, [&](int node, int offset, int count) {
      runs.push_back({node, row + offset, count});
    });
  };
  one.nodes.clear();
  one.moved.clear();
  for (int j = box.j0; j <= box.j1; ++j) add(one.nodes, box.i0, box.i1, j);
  one.problem.outline.for_each_run([&](const Outline::Run& run) {
    add(one.moved, box.i0 + run.i0, box.i0 + run.i1, box.j0 + run.j);
  });
  one.rows = one.plastic_rows = Eigen::Index{box.columns()} * box.rows();
  if (settings_.yields) one.plastic = one.nodes;
}

std::string GridBody::not_held(std::size_t) const {
  if (plan_.is_whole) {
    return "nothing holds a static surface: give it a density or a damping, a clamped edge or two "
           "pinned ones, or a goal";
  }
  return "nothing holds a static surface that is closed along u and v: give it a density, a "
         "damping or a goal, or select less: the forces select all of it";
}

void GridBody::take_material(const BodyInputs& inputs, std::size_t k) {
  Solve& one = solves_[k];
  one.problem.stiffness = inputs.stiffness;
  one.problem.poisson = poisson_of(inputs, *one.patch, factors_.get());
  one.problem.goal = inputs.goal;
  if (one.box == one.patch->box) return;
  one.problem.factors = factors_on(grid_, *one.patch, factors_);
  one.box = one.patch->box;
}

Result<double> GridBody::smallest_eigenvalue_of(std::size_t k) {
  PlateSystem system = solves_[k].problem.system(1);
  system.shift = system.drag = 0;
  return vibrations_.smallest(solvers_.solver_of(system.outline), system);
}

// Tangents apply to the sides at the ends of the whole region, which a ring does not have; SPEC 5.
EdgeTangents GridBody::tangents_of(const EdgeTangents& tangents, std::size_t k) const {
  const Box& box = solves_[k].patch->box;
  const Box& all = plan_.selection.regions[static_cast<std::size_t>(solves_[k].region)].box;
  const bool is_ring_u = grid_.is_ring_u(all), is_ring_v = grid_.is_ring_v(all);
  const auto are_same = [](int line, int other, int count) {
    return line % count == other % count;  // counted round
  };
  EdgeTangents own = tangents;
  if (is_ring_u || !are_same(box.i0, all.i0, grid_.columns)) own.su0.setZero();
  if (is_ring_u || !are_same(box.i1, all.i1, grid_.columns)) own.su1.setZero();
  if (is_ring_v || !are_same(box.j0, all.j0, grid_.rows)) own.sv0.setZero();
  if (is_ring_v || !are_same(box.j1, all.j1, grid_.rows)) own.sv1.setZero();
  return own;
}

void GridBody::find_load(const BodyInputs& inputs, std::size_t k) {
  Solve& one = solves_[k];
  one.problem.load = assemble_load(grid_, room_.tiles.nodes(), inputs.forces, plan_.selection,
                                   static_cast<std::size_t>(one.region), one.patch->box,
                                   inverse_linear(inputs.transform), std::move(one.problem.load));
}

void GridBody::find_displacement(std::size_t k) {
  Solve& one = solves_[k];
  Field& displacement = one.state.displacement;
  displacement.resize(one.rows, 3);
  if (settings_.reference == Reference::Rest) {
    take_difference(one.nodes, first_positions(), rest_, displacement);
  } else {
    take_rows(one.nodes, first_positions(), displacement);
  }
}

Result<void> GridBody::advance(std::size_t k) {
  Solve& one = solves_[k];
  auto next = solvers_.solver_of(one.problem.outline)
                  .advance(one.problem, plan_.steps, std::move(one.state));
  if (!next) return fail(next.error());
  one.state = *std::move(next);
  return {};
}

}  // namespace pliant
