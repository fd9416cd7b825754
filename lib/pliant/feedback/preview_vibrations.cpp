#include <algorithm>
#include <limits>
#include <utility>

#include "pliant/body/patch_plate.hpp"
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
  const auto patches = real_->moved_patches(plan, k);
  std::size_t moved = 0;
  Field ways;
  for (std::size_t patch = 0; patch < patches.size(); ++patch) {
    Field own = displacements(patches[patch].nodes);
    const double size = longest_vector(vectors_to_world(inputs.transform, own)).length;
    const bool is_larger = region.static_peak == 0 && size == 0 &&
                           patches[patch].nodes.size() > patches[moved].nodes.size();
    if (patch > 0 && size <= region.static_peak && !is_larger) continue;
    region.static_peak = std::max(size, region.static_peak);
    moved = patch;
    ways = std::move(own);
  }
  if (known) return moving_as(*known, inputs, std::move(region));
  const auto& [nodes, is_rectangle] = patches[moved];
  if (!is_rectangle && nodes.size() > most_vibrating_nodes) return MovingRegion{std::move(region)};
  // Shapes that are found for an animation of the same load are those of the vibrations too.
  const bool is_elastic = !surface_.material.yield && is_plain(surface_);
  auto* const responding = is_elastic ? response_.patch_of(*real_, inputs, plan, k) : nullptr;
  const auto own = responding ? nullptr : real_->plate_of(inputs, plan, k, moved);
  PatchPlate& patch = responding ? *responding->plate : *own;
  const auto plate = patch.vibrating();
  if (!plate) return fail(plate.error());
  ResponseSpace* space = nullptr;
  if (responding && responding->patterns.cols() == 1 && with_swings_) {
    const auto made = response_.space_of(*responding);
    if (!made) return fail(made.error());
    space = *made;
  }
  // A damping ratio is that of the slowest vibration of all patches.
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t other = 0; other < patches.size(); ++other) {
    if (!inputs.asks_for_vibrations() || other == moved) continue;
    const auto lambda = real_->plate_of(inputs, plan, k, other)->smallest_eigenvalue();
    if (!lambda) return fail(lambda.error());
    least = std::min(least, *lambda);
  }
  const NodeFactors* const factors = shape_.factors.get();
  const double drag = factors ? drag_of(maps_of(*factors, nodes), ways) : 1;
  auto moving = add_vibrations(inputs, *plate, drag, ways, least, std::move(region), space);
  if (moving) moving->preview.solver_memory = patch.memory();
  if (moving && moving->motion && responding) responding->lambda = moving->motion->slowest;
  return moving;
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
  const auto lambda = real_->plate_of(inputs, plan, k, 0)->smallest_eigenvalue();
  if (!lambda) return fail(lambda.error());
  if (*lambda == 0) return MovingRegion{std::move(region)};
  return moving_as(motion_of(inputs, {{*lambda, 1}}, *lambda, 1), inputs, std::move(region));
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
