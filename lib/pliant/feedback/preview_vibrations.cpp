#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "pliant/body/grid_body.hpp"
#include "pliant/body/triangle_body.hpp"
#include "pliant/feedback/preview_body.hpp"

namespace pliant {
namespace {

// What a map of damping makes of it in a vibration of a shape: its mean over the shape's squares,
// relative to that of density, which the shape's eigenvalue knows already. `maps`: the factors of
// density and damping of each unknown; `shape`: its displacements.
double drag_of(const Field& maps, const Field& shape) {
  const bool has_shape = !shape.isZero(0);
  double inertia = 0, drag = 0;
  for (Eigen::Index k = 0; k < shape.rows(); ++k) {
    const double weight = has_shape ? shape.row(k).squaredNorm() : 1;
    inertia += weight * maps(k, 0);
    drag += weight * maps(k, 1);
  }
  return inertia > 0 ? drag / inertia : 1;
}

// The factors of density and damping at nodes, in the first two of three columns.
Field maps_of(const NodeFactors& factors, std::span<const int> nodes) {
  Field maps = Field::Zero(static_cast<Eigen::Index>(nodes.size()), 3);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    maps(static_cast<Eigen::Index>(k), 0) = factor_at(factors.density, nodes[k]);
    maps(static_cast<Eigen::Index>(k), 1) = factor_at(factors.damping, nodes[k]);
  }
  return maps;
}

Dynamics felt_by(const RegionMotion& motion, const BodyInputs& inputs) {
  return motion.felt(inputs.dynamics.density,
                     inputs.damping_ratio.value_or(inputs.dynamics.damping));
}

}  // namespace

Result<MovingRegion> PreviewBody::vibrations(const BodyInputs& inputs, const StepPlan& plan,
                                             std::size_t k, RegionPreview region,
                                             const RegionMotion* known) {
  if (plan.surface) return triangle_vibrations(inputs, *plan.surface, k, std::move(region), known);
  return patch_vibrations(inputs, std::move(region), known);
}

PlateSystem PreviewBody::system_of(const BodyInputs& inputs, const Patch& patch) const {
  PlateSystem system{outline_of(*shape_.grid, patch), inputs.stiffness, 0};
  system.poisson = poisson_of(inputs, patch, shape_.factors.get());
  system.factors = factors_on(*shape_.grid, patch, shape_.factors);
  return system;
}

// Told in the scene's time, for those who watch it.
void PreviewBody::set_natural(const BodyInputs& inputs, const Dynamics& dynamics, double lambda,
                              RegionPreview& region) const {
  const Swing natural = natural_swing(lambda, dynamics);
  region.first_frequency = natural.frequency * (inputs.frame_length / frame_seconds_);
  region.damping_ratio = natural.damping_ratio;
}

Result<MovingRegion> PreviewBody::unheld_vibration(const BodyInputs& inputs, const StepPlan& plan,
                                                   std::size_t k, RegionPreview region,
                                                   const RegionMotion* known) const {
  region.is_held = false;
  if (known) return moving_as(*known, inputs, std::move(region));
  const auto smallest = [&]() -> Result<double> {
    if (!plan.surface) {
      const auto solver = make_plate_solver(SolverChoice::Auto, context_);
      return smallest_eigenvalue(*solver, system_of(inputs, region.region.patches[0]));
    }
    const TrianglePatch& patch = plan.surface->patches[k];
    const NodeFactors* const factors = shape_.factors.get();
    TrianglePlate plate(patch.cells, patch.masses, available_solvers().front(), context_,
                        factors_of(*shape_.surface, plan.surface->level_set, patch, factors));
    return smallest_eigenvalue(plate, response_.bending_at(inputs), patch.is_held());
  };
  const auto lambda = smallest();
  if (!lambda) return fail(lambda.error());
  if (*lambda == 0) return MovingRegion{std::move(region)};
  return moving_as(motion_of(inputs, {{*lambda, 1}}, *lambda, 1), inputs, std::move(region));
}

Result<MovingRegion> PreviewBody::patch_vibrations(const BodyInputs& inputs, RegionPreview region,
                                                   const RegionMotion* known) const {
  const std::vector<Patch>& patches = region.region.patches;
  const Patch* moved = &patches[0];
  int most = 0;
  for (const Patch& patch : patches) {
    const double size = peak(inputs.transform, patch.box).size;
    const bool is_larger = region.static_peak == 0 && size == 0 && patch.interior_count() > most;
    if (size <= region.static_peak && !is_larger) continue;
    region.static_peak = std::max(size, region.static_peak);
    most = patch.interior_count();
    moved = &patch;
  }
  if (known) return moving_as(*known, inputs, std::move(region));
  const Box& box = moved->box;
  const PlateSystem system = system_of(inputs, *moved);
  if (!moved->is_rectangle() && moved->interior_count() > most_vibrating_nodes) {
    return MovingRegion{std::move(region)};
  }
  const auto solver = make_plate_solver(SolverChoice::Auto, context_);
  const auto plate = vibrating(*solver, system);
  if (!plate) return fail(plate.error());
  // A damping ratio is that of the slowest vibration of all patches.
  double least = std::numeric_limits<double>::infinity();
  for (const Patch& patch : patches) {
    if (!inputs.asks_for_vibrations() || &patch == moved) continue;
    const auto other = make_plate_solver(SolverChoice::Auto, context_);
    const auto lambda = smallest_eigenvalue(*other, system_of(inputs, patch));
    if (!lambda) return fail(lambda.error());
    least = std::min(least, *lambda);
  }
  const Field ways = interior_of(system.outline, displacements(box));
  double drag = 1;
  if (system.factors) {
    std::vector<int> nodes(static_cast<std::size_t>(system.outline.grid().node_count()));
    std::iota(nodes.begin(), nodes.end(), 0);
    drag = drag_of(interior_of(system.outline, maps_of(*system.factors, nodes)), ways);
  }
  auto moving = add_vibrations(inputs, *plate, drag, ways, least, std::move(region));
  if (moving) moving->preview.solver_memory = solver->memory();
  return moving;
}

Result<MovingRegion> PreviewBody::triangle_vibrations(const BodyInputs& inputs,
                                                      const TriangleSelection& selection,
                                                      std::size_t k, RegionPreview region,
                                                      const RegionMotion* known) {
  const TrianglePatch& patch = selection.patches[k];
  std::vector<int> nodes;
  for (int n = 0; n < patch.free_nodes; ++n) {
    nodes.push_back(selection.level_set.nodes[patch.points[n]]);
  }
  const Field ways = displacements(nodes);
  const Field world = vectors_to_world(inputs.transform, ways);
  region.static_peak = longest_vector(world).length;
  if (known) return moving_as(*known, inputs, std::move(region));
  if (patch.free_nodes > most_vibrating_nodes) return MovingRegion{std::move(region)};
  const NodeFactors* const factors = shape_.factors.get();
  const Bending bending = response_.bending_at(inputs);
  // Shapes that are found for an animation of the same load are those of the vibrations too.
  const bool is_elastic = !surface_.material.yield && is_plain(surface_);
  auto* const responding = is_elastic ? response_.patch_of(inputs, selection, k) : nullptr;
  std::unique_ptr<TrianglePlate> own;
  if (!responding) {
    own = std::make_unique<TrianglePlate>(
        patch.cells, patch.masses, available_solvers().front(), context_,
        factors_of(*shape_.surface, selection.level_set, patch, factors));
  }
  TrianglePlate& triangles = own ? *own : *responding->plate;
  const auto plate = vibrating(triangles, bending);
  if (!plate) return fail(plate.error());
  ResponseSpace* space = nullptr;
  if (responding && responding->patterns.cols() == 1 && with_swings_) {
    const auto made = response_.space_of(*responding);
    if (!made) return fail(made.error());
    space = *made;
  }
  const double drag = factors ? drag_of(maps_of(*factors, nodes), ways) : 1;
  constexpr double none = std::numeric_limits<double>::infinity();
  auto moving = add_vibrations(inputs, *plate, drag, ways, none, std::move(region), space);
  if (moving) moving->preview.solver_memory = triangles.memory();
  if (moving && moving->motion && responding) responding->lambda = moving->motion->slowest;
  return moving;
}

// `drag`: of the map of damping in the shape of `ways`, the displacement of each unknown, object
// space. `least`: the smallest eigenvalue of other plates of the region, if that matters. `space`:
// of the load; null: it is not known.
Result<MovingRegion> PreviewBody::add_vibrations(const BodyInputs& inputs,
                                                 const VibratingPlate& plate, double drag,
                                                 const Field& ways, double least,
                                                 RegionPreview region, ResponseSpace* space) const {
  if (!(plate.masses.sum() > 0)) return MovingRegion{std::move(region)};  // a map: no weight
  std::vector<ExcitedMode> modes;
  const Field world = vectors_to_world(inputs.transform, ways);
  const auto [size, node] = longest_vector(world);
  if (size > 0 && with_swings_) {
    const Eigen::VectorXd along =
        ways * (inputs.transform.linear.transpose() * (world.row(node).transpose() / size));
    auto excited = space ? space->excited_modes(node) : excited_modes(plate, along, node);
    if (!excited) return fail(excited.error());
    modes = *std::move(excited);
  }
  // Last: it may change what the plate is prepared for.
  const auto lambda = smallest_eigenvalue(plate);
  if (!lambda) return fail(lambda.error());
  if (modes.empty()) modes.push_back({*lambda, 1});
  return moving_as(motion_of(inputs, std::move(modes), std::min(least, *lambda), drag), inputs,
                   std::move(region));
}

// A region that moves so, with the density and damping of the inputs.
MovingRegion PreviewBody::moving_as(const RegionMotion& motion, const BodyInputs& inputs,
                                    RegionPreview region) const {
  const Dynamics felt = felt_by(motion, inputs);
  if (felt.density > 0 || !region.is_held) set_natural(inputs, felt, motion.slowest, region);
  region.animated = motion.swing(felt);
  if (region.is_held) region.settling = motion.settling(felt);
  region.has_vibration = region.is_held;
  return {std::move(region), motion};
}

RegionMotion PreviewBody::motion_of(const BodyInputs& inputs, std::vector<ExcitedMode> modes,
                                    double slowest, double drag) const {
  BodyInputs own;
  own.frame_length = inputs.frame_length;
  own.dt = inputs.dt;
  const auto steps = [&](const Dynamics& dynamics) {
    own.dynamics = dynamics;
    return steps_of(own, real_->settings());
  };
  return {.modes = std::move(modes),
          .slowest = slowest,
          .drag = drag,
          .has_ratio = inputs.damping_ratio.has_value(),
          .frame_seconds = frame_seconds_,
          .interval = inputs.frame_length,
          .stepping = real_->settings().stepping,
          .swinging = steps({1, 1}),
          .creeping = steps({0, 1}),
          .still = steps({0, 0})};
}

}  // namespace pliant
