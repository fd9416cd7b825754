#include "pliant/simulation/preview.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "pliant/plate/vibration.hpp"
#include "pliant/region/region.hpp"
#include "pliant/simulation/sampling.hpp"

namespace pliant {
namespace {

// A sphere around all nodes at rest, in object space: distances to forces are 1-Lipschitz, so a
// force further from its centre than radius and reach together holds no node.
struct Ball {
  Vector3d centre;
  double radius = 0;
};

Ball ball_around(const Field& nodes) {
  const Vector3d centre =
      0.5 * (nodes.colwise().minCoeff() + nodes.colwise().maxCoeff()).transpose();
  return {centre, (nodes.rowwise() - centre.transpose()).rowwise().norm().maxCoeff()};
}

// Whether what a force selects on a surface at rest is the same at all frames.
bool is_still(const Force& force, const Surface& surface) {
  struct IsAnimated {
    bool operator()(const PointChannels& point) const { return point.center.is_animated(); }
    bool operator()(const RadialChannels& radial) const { return radial.center.is_animated(); }
    bool operator()(const LineChannels& line) const {
      return line.from.is_animated() || line.to.is_animated();
    }
  };
  const auto& [translate, rotate, scale, order] = surface.transform;
  return !translate.is_animated() && !rotate.is_animated() && !scale.is_animated() &&
         !force.deformation_radius.is_animated() && !std::visit(IsAnimated{}, force.shape);
}

class Previewer {
 public:
  Previewer(const Simulation& simulation, const SimulationOptions& options)
      : scene_(simulation.scene()),
        rest_shapes_(simulation.rest_shapes()),
        should_stop_(options.should_stop),
        memory_(options.max_memory - std::min(options.max_memory, simulation.surface_memory())) {}

  Result<std::vector<ForcePreview>> preview() {
    std::vector<ForcePreview> previews;
    for (std::size_t surface = 0; surface < scene_.surfaces.size(); ++surface) {
      if (!scene_.surfaces[surface].enabled) continue;
      ball_ = ball_around(rest_shapes_[surface].mapping.rest);
      for (std::size_t force = 0; force < scene_.forces.size(); ++force) {
        if (!targets(scene_.forces[force], scene_.surfaces[surface].name)) continue;
        auto previewed = preview(surface, force);
        if (!previewed) return fail(previewed.error());
        if (*previewed) previews.push_back(**previewed);
      }
    }
    return previews;
  }

 private:
  // Nothing of a force that is never enabled.
  Result<std::optional<ForcePreview>> preview(std::size_t surface_index, std::size_t force_index) {
    const Surface& surface = scene_.surfaces[surface_index];
    const Force& force = scene_.forces[force_index];
    ForcePreview result;
    result.surface = surface_index;
    result.force = force_index;
    bool is_ever_enabled = false;
    distances_left_ = 1'000'000'000;
    const int first = std::max(scene_.start, surface.solver.start_frame.value_or(scene_.start));
    for (int frame = first; frame <= scene_.end; ++frame) {
      if (!force.enabled.at(frame)) continue;
      if (should_stop_ && should_stop_()) return fail(ErrorCode::Interrupted, "interrupted");
      const double magnitude = force.magnitude.at(frame)[0];
      if (!is_ever_enabled || std::abs(magnitude) > std::abs(result.magnitude)) {
        result.magnitude = magnitude;
        result.magnitude_frame = frame;
      }
      is_ever_enabled = true;
      if (!result.frame) look(surface_index, force, frame, result);
    }
    if (!is_ever_enabled) return std::optional<ForcePreview>();
    result.is_solvable = result.region.columns() >= 3 && result.region.rows() >= 3;
    result.is_solved = result.is_solvable &&
                       (result.region.columns() - 2) * std::int64_t{result.region.rows() - 2} <=
                           most_previewed_unknowns;
    if (!result.is_solved) return result;
    if (auto solved = solve(result); !solved) return fail(solved.error());
    return result;
  }

  // Whether the force selects something at this frame.
  void look(std::size_t surface, const Force& force, int frame, ForcePreview& result) {
    const Transform transform = sample_transform(scene_.surfaces[surface].transform, frame);
    const SampledForce sampled = sample_force(force, frame);
    if (distances_left_ < 0) return;
    // Where nothing moves, one look tells of all frames.
    if (is_still(force, scene_.surfaces[surface])) distances_left_ = 0;
    const Vector3d centre = transform.linear * ball_.centre + transform.translation;
    const double reach = ball_.radius * transform.linear.norm() + sampled.deformation_radius;
    if (distance(sampled.shape, centre) > 1.001 * reach) return;
    const GridMapping& mapping = rest_shapes_[surface].mapping;
    distances_left_ -= mapping.grid.node_count();
    const Box region =
        select_region(mapping.grid, to_world(transform, mapping.rest), {&sampled, 1}).region;
    if (region.is_empty()) return;
    result.frame = frame;
    result.region = region;
  }

  Result<void> solve(ForcePreview& result) {
    const SurfaceInputs inputs =
        sample_inputs(scene_, scene_.surfaces[result.surface], *result.frame);
    const GridMapping& mapping = rest_shapes_[result.surface].mapping;
    const Grid region{result.region.columns(), result.region.rows(), mapping.grid.hu,
                      mapping.grid.hv};
    SampledForce force = sample_force(scene_.forces[result.force], *result.frame);
    force.magnitude = result.magnitude;
    const Field nodes = to_world(inputs.body.transform, mapping.rest);
    const Selection selection = select_region(mapping.grid, nodes, {&force, 1});
    const Field load = vectors_to_object(
        inputs.body.transform, assemble_load(mapping.grid, nodes, {&force, 1}, selection));

    const auto solver = make_solver(available_solvers().front(), &memory_);
    const auto lambda = smallest_eigenvalue(*solver, region, inputs.body.stiffness, should_stop_);
    if (!lambda) return fail(lambda.error());
    const auto settled = solver->solve(interior_of(region, load));
    if (!settled) return fail(settled.error());
    result.static_peak =
        vectors_to_world(inputs.body.transform, *settled).rowwise().norm().maxCoeff();
    const auto& [density, damping] = inputs.body.dynamics;
    if (density > 0) {
      // rho q'' + eta q' + lambda q = 0 for the slowest vibration.
      result.frequency = std::sqrt(*lambda / density) / (2 * std::numbers::pi);
      result.damping_ratio = damping / (2 * std::sqrt(*lambda * density));
    }
    result.solver_memory = solver->memory();
    return {};
  }

  const Scene& scene_;
  std::span<const RestShape> rest_shapes_;
  StopRequest should_stop_;
  MemoryBudget memory_;
  Ball ball_;                        // around the surface in hand
  std::int64_t distances_left_ = 0;  // that may be measured for a pair
};

}  // namespace

Result<std::vector<ForcePreview>> preview_forces(const Simulation& simulation,
                                                 const SimulationOptions& options) {
  return Previewer(simulation, options).preview();
}

}  // namespace pliant
