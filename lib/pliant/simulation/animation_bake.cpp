#include "pliant/simulation/animation_bake.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/stage_timer.hpp"
#include "pliant/core/text.hpp"
#include "pliant/scene/inputs.hpp"

namespace pliant {

AnimationBake::AnimationBake(const Simulation& simulation, const AnimationOptions& options)
    : simulation_(&simulation),
      surfaces_(options.surfaces),
      is_world_(options.is_world),
      plan_{.file = options.file,
            .first_frame = options.frames.first,
            .last_frame = options.frames.last,
            .fps = simulation.scene().fps,
            .is_placed = !options.is_world,
            .resume = options.resume,
            .should_stop = options.should_stop} {
  for (std::size_t k = 0; options.surfaces.empty() && k < simulation.rest_shapes().size(); ++k)
    surfaces_.push_back(k);
}

Result<AnimationBake> AnimationBake::make(const Simulation& simulation,
                                          const AnimationOptions& options) {
  AnimationBake bake(simulation, options);
  const Scene& scene = simulation.scene();
  for (const std::size_t k : bake.surfaces_) {
    if (is_stopped(options.should_stop)) return interrupted();
    const RestShape& shape = simulation.rest_shapes()[k];
    const Placement first = scene.surfaces[k].transform.placement_at(options.frames.first);
    const Transform transform = options.is_world ? make_transform(first) : Transform();
    bake.plan_.surfaces.push_back({.name = shape.name,
                                   .mesh = &shape.mesh,
                                   .rest = options.is_world
                                               ? to_world(transform, shape.mesh.positions)
                                               : shape.mesh.positions,
                                   .is_mirrored = transform.is_mirrored()});
  }
  if (options.omits_colliders) return bake;
  const std::size_t used = std::min(options.max_memory, simulation.surface_memory());
  auto colliders = DrawnColliders::make(scene, simulation.collider_meshes(), bake.plan_,
                                        options.max_memory - used);
  if (!colliders) return fail(colliders.error());
  bake.colliders_ = *std::move(colliders);
  bake.plan_.colliders = bake.colliders_.surfaces();
  return bake;
}

Result<void> AnimationBake::check_inputs() const {
  const Scene& scene = simulation_->scene();
  const auto refuse = [&](const std::filesystem::path& input) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("{}: would overwrite {}, an input of the scene; choose another name",
                            printable(plan_.file), printable(input.string())));
  };
  const InputFinder inputs(scene, plan_.should_stop);
  for (const SceneInput& input : inputs.inputs())
    if (is_named_at_the_end(plan_, input.file.filename().string())) return refuse(input.file);
  for (const std::string& output : files_of(plan_))
    if (const auto input = inputs.find(output)) return refuse(*input);
  return {};
}

Result<void> AnimationBake::begin() {
  auto writer = make_writer(plan_);
  if (!writer) return fail(writer.error());
  writer_ = *std::move(writer);
  return {};
}

Result<void> AnimationBake::write(const Frame& frame) {
  ++frame_count_;
  poses_.resize(surfaces_.size());
  StageTimer posing(&profile_, Stage::Output);
  for (std::size_t n = 0; n < surfaces_.size(); ++n) {
    const std::size_t k = surfaces_[n];
    const SurfaceFrame& surface = frame.surfaces()[k];
    SurfacePose& pose = poses_[n];
    if (surface.peak_displacement() > peak_displacement_)
      peak_displacement_ = std::max(peak_displacement_, surface.told_displacement());
    if (is_world_) {
      pose.positions = surface.positions(std::move(pose.positions));
      pose.is_mirrored = surface.transform().is_mirrored();
    } else {
      pose.positions = surface.object_positions();
      pose.placement = simulation_->scene().surfaces[k].transform.placement_at(frame.number());
    }
  }
  posing.stop();
  const StageTimer writing(&profile_, Stage::Writing);
  auto colliders = colliders_.at(frame.number());
  if (!colliders) return fail(colliders.error());
  return writer_->write(frame.number(), poses_, *std::move(colliders));
}

Result<void> AnimationBake::finish() {
  const StageTimer writing(&profile_, Stage::Writing);
  return writer_->finish();
}

long AnimationBake::vertex_count() const {
  long count = 0;
  for (const std::size_t k : surfaces_) count += simulation_->rest_shapes()[k].mesh.vertex_count();
  return count;
}

}  // namespace pliant
