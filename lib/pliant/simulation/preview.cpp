#include "pliant/simulation/preview.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>

#include <fmt/format.h>

#include "pliant/plate/plate_solver.hpp"
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

// Whether the distances to a force may change over time.
struct HasMovingDistance {
  bool operator()(const PointChannels& point) const { return point.center.is_animated(); }
  bool operator()(const RadialChannels& radial) const { return radial.center.is_animated(); }
  bool operator()(const LineChannels& line) const {
    return line.from.is_animated() || line.to.is_animated();
  }
  bool operator()(const UniformChannels&) const { return false; }
  bool operator()(const VortexChannels& vortex) const {
    return vortex.center.is_animated() || vortex.axis.is_animated();
  }
  bool operator()(const NoiseChannels& noise) const { return noise.center.is_animated(); }
  bool operator()(const InertiaChannels&) const { return false; }
  bool operator()(const CustomForce&) const { return true; }
};

// Whether what a force, or the group that it is in, selects on a surface at rest is the same at all
// frames.
bool is_still(const Force& force, const Group* group, const Surface& surface) {
  const auto& [translate, rotate, scale, order] = surface.transform;
  if (translate.is_animated() || rotate.is_animated() || scale.is_animated()) return false;
  if (group) return !group->center.is_animated() && !group->deformation_radius.is_animated();
  return !force.deformation_radius.is_animated() && !std::visit(HasMovingDistance{}, force.shape);
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
        const Group* group = group_of(scene_, scene_.forces[force]);
        if (!targets(scene_.forces[force], group, scene_.surfaces[surface].name)) continue;
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
    const Group* group = group_of(scene_, force);
    ForcePreview result;
    result.surface = surface_index;
    result.force = force_index;
    bool is_ever_enabled = false;
    distances_left_ = 1'000'000'000;
    const int first = std::max(scene_.start, surface.solver.start_frame.value_or(scene_.start));
    for (int frame = first; frame <= scene_.end; ++frame) {
      if (!is_enabled(force, group, frame)) continue;
      if (should_stop_ && should_stop_()) return fail(ErrorCode::Interrupted, "interrupted");
      const double magnitude = force.magnitude.at(frame)[0];
      if (!is_ever_enabled || std::abs(magnitude) > std::abs(result.magnitude)) {
        result.magnitude = magnitude;
        result.magnitude_frame = frame;
      }
      is_ever_enabled = true;
      if (!result.frame) look(surface, force, frame, result);
      if (auto sound = check_faults(surface, frame); !sound) return fail(sound.error());
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

  // Whether the force, or the group that it is in, selects something at this frame.
  void look(const Surface& surface, const Force& force, int frame, ForcePreview& result) {
    if (distances_left_ < 0) return;
    const Group* group = group_of(scene_, force);
    const Transform transform = sample_transform(surface.transform, frame);
    const SampledForce sampled =
        group ? sample_group(*group, frame) : sample_force(scene_, force, surface, frame, faults_);
    // Where nothing moves, one look tells of all frames.
    if (is_still(force, group, surface)) distances_left_ = 0;
    const Vector3d centre = transform.linear * ball_.centre + transform.translation;
    const double reach = ball_.radius * transform.linear.norm() + sampled.deformation_radius;
    // Nothing is known of how a custom force's distance grows.
    const bool is_custom = std::holds_alternative<FunctionForce>(sampled.shape);
    if (!is_custom && distance(sampled.shape, centre) > 1.001 * reach) return;
    const GridMapping& mapping = rest_shapes_[result.surface].mapping;
    distances_left_ -= mapping.grid.node_count();
    const Box region =
        select_region(mapping.grid, to_world(transform, mapping.rest), {&sampled, 1}).region;
    if (region.is_empty()) return;
    result.frame = frame;
    result.region = region;
  }

  Result<void> solve(ForcePreview& result) {
    const Surface& surface = scene_.surfaces[result.surface];
    const BodyInputs body = sample_body(scene_, surface, *result.frame);
    const GridMapping& mapping = rest_shapes_[result.surface].mapping;
    const Grid region{result.region.columns(), result.region.rows(), mapping.grid.hu,
                      mapping.grid.hv};
    const Force& force = scene_.forces[result.force];
    std::vector<SampledForce> acting = {
        sample_force(scene_, force, surface, *result.frame, faults_)};
    acting.front().magnitude = result.magnitude;
    if (const Group* group = group_of(scene_, force)) {
      acting.push_back(sample_group(*group, *result.frame));
    }
    const Field nodes = to_world(body.transform, mapping.rest);
    const Selection selection = select_region(mapping.grid, nodes, acting);
    const Field load =
        vectors_to_object(body.transform, assemble_load(mapping.grid, nodes, acting, selection));
    if (auto sound = check_faults(surface, *result.frame); !sound) return sound;

    // The one that a run takes for such a region.
    const bool is_spectral = worth_transforming(region, body.stiffness);
    const auto solver =
        make_solver(is_spectral ? SolverKind::Spectral : available_solvers().front(), &memory_);
    const auto lambda = smallest_eigenvalue(*solver, region, body.stiffness, should_stop_);
    if (!lambda) return fail(lambda.error());
    const auto settled = solver->solve(interior_of(region, load));
    if (!settled) return fail(settled.error());
    result.static_peak = vectors_to_world(body.transform, *settled).rowwise().norm().maxCoeff();
    const auto& [density, damping] = body.dynamics;
    if (density > 0) {
      // rho q'' + eta q' + lambda q = 0 for the slowest vibration.
      result.frequency = std::sqrt(*lambda / density) / (2 * std::numbers::pi);
      result.damping_ratio = damping / (2 * std::sqrt(*lambda * density));
    }
    result.solver_memory = solver->memory();
    return {};
  }

  Result<void> check_faults(const Surface& surface, int frame) const {
    const std::string fault = faults_->first();
    if (fault.empty()) return {};
    return fail(ErrorCode::NotFinite,
                fmt::format("surface \"{}\", frame {}: {}", surface.name, frame, fault),
                scene_.origin.file, scene_.origin.line_of(surface.name));
  }

  const Scene& scene_;
  std::span<const RestShape> rest_shapes_;
  StopRequest should_stop_;
  MemoryBudget memory_;
  Ball ball_;                        // around the surface in hand
  std::int64_t distances_left_ = 0;  // that may be measured for a pair
  std::shared_ptr<ForceFaults> faults_ = std::make_shared<ForceFaults>();
};

}  // namespace

Result<std::vector<ForcePreview>> preview_forces(const Simulation& simulation,
                                                 const SimulationOptions& options) {
  return Previewer(simulation, options).preview();
}

}  // namespace pliant
