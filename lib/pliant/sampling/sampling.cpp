#include "pliant/sampling/sampling.hpp"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/format/description.hpp"

namespace pliant {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

Vector3d to_vector(const Value<3>& value) { return {value[0], value[1], value[2]}; }

// What carries the places and directions of a force or group. SPEC 7.
class Followed {
 public:
  template <class Follower>
  Followed(const Scene& scene, const Follower& follower, int frame, ForceFaults& faults,
           const Carriers& carriers)
      : scene_(scene),
        name_(follower.name),
        surface_(follower.follow),
        frame_(frame),
        faults_(faults),
        carriers_(carriers) {}

  // The place in the world. Directions turn with the first place that is asked for.
  Vector3d place(const PositionChannel& channel) {
    Vector3d place = to_vector(channel.at(frame_));
    if (surface_.empty()) return place;
    auto carried = carriers_.carry(scene_, surface_, place, frame_);
    if (!carried) {
      faults_.add(fmt::format("{} follows {}: {}", name_, surface_, carried.error().message));
      return place;
    }
    if (!first_) first_ = *carried;
    return carried->place;
  }

  Vector3d direction(const Channel<3>& channel) const {
    Vector3d direction = to_vector(channel.at(frame_));
    if (!first_) return direction;
    return to_world({first_->directions, Vector3d::Zero()}, direction);
  }

  std::optional<Matrix3d> rotation() const {
    return first_ ? std::optional(first_->rotation) : std::nullopt;
  }

  // The value of a channel of any type.
  void sample(const Channel<1>& channel, double& value) { value = channel.at(frame_)[0]; }
  void sample(const PositionChannel& channel, Vector3d& value) { value = place(channel); }
  void sample(const Channel<3>& channel, Vector3d& value) { value = direction(channel); }
  void sample(const std::optional<Channel<3>>& channel, std::optional<Vector3d>& value) {
    if (channel) value = direction(*channel);
  }

 private:
  const Scene& scene_;
  const std::string& name_;
  const std::string& surface_;
  int frame_;
  ForceFaults& faults_;
  const Carriers& carriers_;
  std::optional<Carried> first_;
};

// A tangent of one number applies to all of x, y, z. SPEC 3.
Vector3d sample_tangent(const TangentChannel& channel, int frame) {
  if (const auto* number = std::get_if<Channel<1>>(&channel)) {
    return Vector3d::Constant(number->at(frame)[0]);
  }
  return to_vector(std::get<Channel<3>>(channel).at(frame));
}

// -rho (X(f+1) - 2 X(f) + X(f-1)) p / T^2 for a surface's transform X and its frame length T, as a
// function of the point X(f) p in the world. It is computed from differences of transforms, so that
// it is exactly 0 for a surface at rest or in uniform motion if these differences are exact.
//
// Of an animated shape R, X(k) (R(k) + w) is X(k) applied to the point's own place in object space,
// R(f) + w, and to R(k) - R(f): the part of each node.
InertiaForce sample_inertia(const Surface& surface, double fps, int frame,
                            const ShapeFrames& shape) {
  const Transform before = surface.transform.at(frame - 1);
  const Transform now = surface.transform.at(frame);
  const Transform after = surface.transform.at(frame + 1);
  const double rate = fps / surface.solver.time_scale.at(frame)[0];  // of frames, in its own time
  const double scale = -surface.material.density.at(frame)[0] * rate * rate;
  const Matrix3d turning = (after.linear - now.linear) - (now.linear - before.linear);
  // Row k: the object-space vector of the world's axis k.
  const Matrix3d axes = inverse_linear(now).transpose();
  InertiaForce inertia;
  inertia.origin = now.translation;
  inertia.offset =
      scale * ((after.translation - now.translation) - (now.translation - before.translation));
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 3; ++k) {
      inertia.linear(row, k) =
          scale * (turning(row, 0) * axes(k, 0) + turning(row, 1) * axes(k, 1) +
                   turning(row, 2) * axes(k, 2));
    }
  }
  if (!shape.now) return inertia;
  const Field ways_after = vectors_to_world(after, *shape.after - *shape.now);
  const Field ways_before = vectors_to_world(before, *shape.now - *shape.before);
  inertia.of_nodes = std::make_shared<const Field>(scale * (ways_after - ways_before));
  return inertia;
}

std::string place_text(const Vector3d& p) {
  return fmt::format("({}, {}, {})", p.x(), p.y(), p.z());
}

// The program's functions at one time, with checks of their results. What they leave out is not
// finite.
SampledCustomForce sample_custom(const CustomForce& custom, const std::string& name,
                                 const ForceTime& time,
                                 const std::shared_ptr<ForceFaults>& faults) {
  // By value: a report of a frame may outlive the scene.
  const auto distance = [function = custom.distance, name, time, faults](
                            std::span<const Vector3d> points, std::span<double> distances) {
    if (!function) {
      std::ranges::fill(distances, 0);
      return;
    }
    if (function.is_of_many()) std::ranges::fill(distances, not_a_number);
    function(points, time, distances);
    bool is_sound = true;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (distances[k] >= 0) continue;
      if (std::exchange(is_sound, false))
        faults->add(fmt::format("force \"{}\": its distance at {} is {}, but must be at least 0",
                                name, place_text(points[k]), distances[k]));
      distances[k] = std::numeric_limits<double>::infinity();
    }
  };
  const auto unit_force = [function = custom.unit_force, name, time, faults](
                              std::span<const Vector3d> points, std::span<Vector3d> forces) {
    if (function.is_of_many()) std::ranges::fill(forces, Vector3d::Constant(not_a_number));
    function(points, time, forces);
    bool is_sound = true;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (forces[k].allFinite()) continue;
      if (std::exchange(is_sound, false))
        faults->add(fmt::format("force \"{}\": its unit_force at {} is {}, which is not finite",
                                name, place_text(points[k]), place_text(forces[k])));
      forces[k] = Vector3d::Zero();
    }
  };
  return {distance, unit_force, custom.distance.is_of_many() || custom.unit_force.is_of_many()};
}

struct SampleShape {
  const Scene& scene;
  const Force& force;
  const Surface& surface;
  int frame;
  const std::shared_ptr<ForceFaults>& faults;
  NoiseClock* clock;  // null: the sum is computed here
  const ShapeFrames& shape;
  Followed& followed;

  double seconds() const { return frame / scene.fps; }

  // The time in cells at the frame, summed with the rate of each frame, so that the pattern never
  // jumps. docs/model.md, "Forces".
  double noise_cells(const Channel<1>& rate) const {
    if (!rate.is_animated() || frame == scene.start) return rate.at(frame)[0] * seconds();
    const auto rate_at = [&](int earlier) { return rate.at(earlier)[0]; };
    if (clock) return clock->sum(frame, rate_at) / scene.fps;
    return NoiseClock(scene.start).sum(frame, rate_at) / scene.fps;
  }

  template <class Kind>
  ForceKind operator()(const Kind& kind) const {
    typename Description<Kind>::Sampled sampled;
    const auto row = [this](const Attribute&, const auto& channel, auto& value) {
      followed.sample(channel, value);
    };
    describe(row, kind, sampled);
    return sampled;
  }
  ForceKind operator()(const NoiseChannels& noise) const {
    const Vector3d center = followed.place(noise.center);
    return NoiseForce{center, noise.frequency.at(frame)[0], noise_cells(noise.rate),
                      noise.seed.value_or(scene.seed), followed.rotation()};
  }
  ForceKind operator()(const InertiaChannels&) const {
    return sample_inertia(surface, scene.fps, frame, shape);
  }
  ForceKind operator()(const CustomForce& custom) const {
    return sample_custom(custom, force.name, {frame, seconds()}, faults);
  }
};

ColliderPose sample_pose(const Collider& collider, int frame, const ColliderMesh* mesh,
                         ForceFaults& faults) {
  const auto posed_mesh = [&]() -> Solid {
    PLIANT_EXPECTS(mesh != nullptr);
    auto posed = mesh->at(frame);
    if (posed) return MeshSolid{*std::move(posed)};
    faults.add(posed.error().message);
    return MeshSolid{mesh->at_rest()};
  };
  auto shape = shape_at(collider, frame);
  return {shape ? *std::move(shape) : posed_mesh(), collider.transform.placement_at(frame),
          collider.offset.at(frame)[0]};
}

bool holds(const std::vector<std::string>& targets, const std::string& surface) {
  return targets.empty() || std::find(targets.begin(), targets.end(), surface) != targets.end();
}

}  // namespace

void ForceFaults::add(std::string message) {
  const std::lock_guard lock(mutex_);
  if (first_.empty()) first_ = std::move(message);
}

std::string ForceFaults::first() const {
  const std::lock_guard lock(mutex_);
  return first_;
}

void ForceFaults::clear() {
  const std::lock_guard lock(mutex_);
  first_.clear();
}

std::unique_ptr<NoiseClock> clock_of(const Force& force, int start) {
  const auto* const noise = std::get_if<NoiseChannels>(&force.kind);
  if (!noise || !noise->rate.is_animated()) return nullptr;
  return std::make_unique<NoiseClock>(start);
}

SceneSampling::SceneSampling(const Scene& scene)
    : targets_(targets_of(scene)),
      animations_(scene.surfaces.size()),
      meshes_(scene.colliders.size()),
      carriers_(std::make_shared<const Carriers>(scene)) {
  for (const Force& force : scene.forces) clocks_.push_back(clock_of(force, scene.start));
}

void SceneSampling::tell(std::size_t surface, const RestShape& shape) {
  animations_[surface] = shape.animation;
  if (shape.carriers) carriers_ = shape.carriers;
}

ShapeFrames sample_shape(const AnimatedShape* animation, int frame, ForceFaults& faults) {
  if (!animation) return {};
  auto shape = animation->frames_around(frame);
  if (shape) return *std::move(shape);
  faults.add(shape.error().message);
  return {animation->at_rest(), animation->at_rest(), animation->at_rest()};
}

SampledForce sample_force(const Scene& scene, const Force& force, const Surface& surface, int frame,
                          const std::shared_ptr<ForceFaults>& faults, const Carriers& carriers,
                          NoiseClock* clock, const ShapeFrames& shape) {
  Followed followed(scene, force, frame, *faults, carriers);
  const SampleShape sample{scene, force, surface, frame, faults, clock, shape, followed};
  const bool selects = force.group.empty() && surface.solver.region == SolvedRegion::Forces;
  return {.kind = std::visit(sample, force.kind),
          .magnitude = force.magnitude.at(frame)[0],
          .deformation_radius = selects ? force.deformation_radius.at(frame)[0] : 0,
          .force_radius = force.force_radius.at(frame)[0],
          .falloff = force.falloff,
          .falloff_curve = force.falloff_curve ? &*force.falloff_curve : nullptr,
          .is_along_normal = force.along == PushAlong::Normal};
}

SampledForce sample_group(const Scene& scene, const Group& group, int frame, ForceFaults& faults,
                          const Carriers& carriers) {
  Followed followed(scene, group, frame, faults, carriers);
  return region_sphere(followed.place(group.center), group.deformation_radius.at(frame)[0]);
}

Force in_world(const Scene& scene, const Force& force, int frame, const Carriers& carriers) {
  if (force.follow.empty()) return force;
  ForceFaults faults;
  Followed followed(scene, force, frame, faults, carriers);
  Force placed = force;
  const auto place = [&]<class Channel>(const Attribute&, Channel& channel) {
    if constexpr (std::is_same_v<Channel, PositionChannel> ||
                  std::is_same_v<Channel, pliant::Channel<3>>) {
      Vector3d value;
      followed.sample(channel, value);
      channel = Value<3>{value.x(), value.y(), value.z()};
    }
  };
  const auto row = [&](const Attribute& attribute, auto& channel) {
    if constexpr (requires { channel.has_value(); }) {
      if (channel) place(attribute, *channel);
    } else {
      place(attribute, channel);
    }
  };
  std::visit([&](auto& kind) { describe(row, kind); }, placed.kind);
  placed.follow.clear();
  return placed;
}

Group in_world(const Scene& scene, const Group& group, int frame, const Carriers& carriers) {
  if (group.follow.empty()) return group;
  ForceFaults faults;
  const Vector3d center = Followed(scene, group, frame, faults, carriers).place(group.center);
  Group placed = group;
  placed.center = Value<3>{center.x(), center.y(), center.z()};
  placed.follow.clear();
  return placed;
}

const Group* group_of(const Scene& scene, const Force& force) {
  if (force.group.empty()) return nullptr;
  const auto found = std::find_if(scene.groups.begin(), scene.groups.end(),
                                  [&](const Group& group) { return group.name == force.group; });
  return found != scene.groups.end() ? &*found : nullptr;
}

bool is_enabled(const Force& force, const Group* group, int frame) {
  return force.enabled.at(frame) && (!group || group->enabled.at(frame));
}

bool targets(const Force& force, const Group* group, const std::string& surface) {
  return holds(force.targets, surface) && (!group || holds(group->targets, surface));
}

int first_frame_of_run(const Scene& scene) {
  int first = sampled_frames(scene).first;
  for (const Surface& surface : scene.surfaces) {
    if (begins_cycle(scene, surface, scene.start)) first = std::min(first, scene.start - 1);
  }
  return first;
}

int solved_frame(const Scene& scene, const Surface& surface, int frame) {
  const int first = first_solved_frame(scene, surface);
  const std::optional<int> loop = surface.solver.loop;
  return loop && frame > first ? first + (frame - first) % *loop : frame;
}

bool begins_cycle(const Scene& scene, const Surface& surface, int frame) {
  const int first = first_solved_frame(scene, surface);
  return surface.enabled && !surface.is_driven() && surface.solver.loop && frame >= first &&
         (frame - first) % *surface.solver.loop == 0;
}

bool is_solved_at(const Scene& scene, const Surface& surface, int frame) {
  return surface.enabled && !surface.is_driven() && frame >= first_solved_frame(scene, surface) &&
         frame_length(scene, surface, solved_frame(scene, surface, frame)) > 0;
}

BodySettings body_settings(const Surface& surface, bool is_grid) {
  const SolverSettings& solver = surface.solver;
  return {.integrator = solver.integrator,
          .stepping = solver.stepping,
          .reference = solver.reference,
          .measure = solver.measure.value_or(is_grid ? Measure::Current : Measure::Rest),
          .region = solver.region,
          .combine = solver.combine,
          .release = solver.release,
          .border = surface.reading.border.value_or(Border::Clamped),
          .edges = solver.edges,
          .is_animated = surface.is_animated(),
          .yields = surface.material.yield.has_value()};
}

BodyInputs sample_body(const Scene& scene, const Surface& surface, int frame,
                       const ShapeFrames& shape) {
  const MaterialChannels& material = surface.material;
  const TangentChannels& tangents = surface.tangents;
  return {.transform = surface.transform.at(frame),
          .stiffness = {material.b.at(frame)[0], material.c.at(frame)[0], material.d.at(frame)[0]},
          .dynamics = {material.density.at(frame)[0],
                       material.damping_ratio ? 0 : material.damping.at(frame)[0]},
          .damping_ratio = material.damping_ratio
                               ? std::optional(material.damping_ratio->at(frame)[0])
                               : std::nullopt,
          .tangents = {sample_tangent(tangents.su0, frame), sample_tangent(tangents.su1, frame),
                       sample_tangent(tangents.sv0, frame), sample_tangent(tangents.sv1, frame)},
          .poisson = material.poisson.at(frame)[0],
          .law = material.yield ? std::optional(PlasticLaw{material.yield->at(frame)[0],
                                                           material.hardening.at(frame)[0]})
                                : std::nullopt,
          .goal = material.goal.at(frame)[0],
          .frame_length = frame_length(scene, surface, frame),
          .dt = surface.solver.dt.at(frame)[0],
          .forces = {},
          .shape = shape.now};
}

std::optional<Solid> shape_at(const Collider& collider, int frame) {
  struct At {
    int frame;

    std::optional<Solid> operator()(const SphereChannels& sphere) const {
      return SphereSolid{sphere.radius.at(frame)[0]};
    }
    std::optional<Solid> operator()(const CapsuleChannels& capsule) const {
      return CapsuleSolid{capsule.radius.at(frame)[0], capsule.length.at(frame)[0]};
    }
    std::optional<Solid> operator()(const BoxChannels& box) const {
      return BoxSolid{to_vector(box.size.at(frame)), box.round.at(frame)[0]};
    }
    std::optional<Solid> operator()(const PlaneChannels&) const { return PlaneSolid{}; }
    std::optional<Solid> operator()(const ClosedMesh&) const { return std::nullopt; }
  };
  return std::visit(At{frame}, collider.shape);
}

std::optional<Solid> solid_at(const Collider& collider, int frame, const ColliderMesh* mesh) {
  if (std::holds_alternative<ClosedMesh>(collider.shape) && !mesh) return std::nullopt;
  ForceFaults faults;
  const ColliderPose pose = sample_pose(collider, frame, mesh, faults);
  if (!faults.first().empty()) return std::nullopt;
  return placed({pose, pose}, 0).kept.solid;
}

void sample_colliders(const Scene& scene, const Surface& surface, const MetColliders& met,
                      int frame, BodyInputs& inputs, ForceFaults& faults) {
  inputs.colliders.clear();
  for (const std::size_t k : met.colliders) {
    const Collider& collider = scene.colliders[k];
    if (!collider.enabled.at(frame)) continue;
    const bool selects = surface.solver.region == SolvedRegion::Forces;
    const ColliderMesh* const mesh = k < met.meshes.size() ? met.meshes[k].get() : nullptr;
    const auto pose = [&](int at) { return sample_pose(collider, at, mesh, faults); };
    inputs.colliders.push_back(
        {pose(frame), pose(frame + 1), selects ? collider.deformation_radius.at(frame)[0] : 0,
         collider.friction.at(frame)[0], collider.stick.at(frame), static_cast<int>(k)});
  }
  if (inputs.colliders.empty()) return;
  inputs.motion = {surface.transform.placement_at(frame),
                   surface.transform.placement_at(frame + 1)};
  if (!met.animation) return;
  if (auto next = met.animation->nodes_at(frame + 1)) {
    inputs.motion->next_shape = *std::move(next);
  } else {
    faults.add(next.error().message);
  }
}

SurfaceInputs sample_inputs(const Scene& scene, const SceneSampling& sampling, std::size_t surface,
                            int frame, SurfaceInputs reuse) {
  frame = solved_frame(scene, scene.surfaces[surface], frame);
  const SurfaceTargets& targets = sampling.targets(surface);
  const bool is_whole = scene.surfaces[surface].solver.region == SolvedRegion::All;
  SurfaceInputs inputs = std::move(reuse);
  // Reports of earlier frames may still refer to theirs.
  if (inputs.faults.use_count() == 1) {
    inputs.faults->clear();
  } else {
    inputs.faults = std::make_shared<ForceFaults>();
  }
  const ShapeFrames shape = sample_shape(sampling.animation(surface), frame, *inputs.faults);
  BodyInputs body = sample_body(scene, scene.surfaces[surface], frame, shape);
  body.forces = std::move(inputs.body.forces);
  body.selectors = std::move(inputs.body.selectors);
  inputs.body = std::move(body);
  std::vector<SampledForce>& forces = inputs.body.forces;
  std::vector<int>& selectors = inputs.body.selectors;
  forces.clear();
  selectors.clear();
  inputs.sources.clear();
  const MetColliders met{targets.colliders, sampling.meshes(), sampling.animation(surface)};
  sample_colliders(scene, scene.surfaces[surface], met, frame, inputs.body, *inputs.faults);

  for (const auto& [index, place] : targets.forces) {
    const Force& force = scene.forces[index];
    const Group* const group = place >= 0 ? &scene.groups[targets.groups[place]] : nullptr;
    if (!is_enabled(force, group, frame)) continue;
    forces.push_back(sample_force(scene, force, scene.surfaces[surface], frame, inputs.faults,
                                  sampling.carriers(), sampling.clock(index), shape));
    const auto* const custom = std::get_if<CustomForce>(&force.kind);
    inputs.sources.push_back({force.name, kind_of(force), force.targets, !group && !is_whole,
                              custom ? std::string_view(custom->key) : std::string_view()});
    // The selectors of groups are not known yet: -1 - place stands for them.
    const bool follows = group && !is_whole;
    selectors.push_back(follows ? -1 - place : static_cast<int>(selectors.size()));
  }
  if (is_whole) return inputs;
  const std::size_t member_count = selectors.size();
  std::vector<int>& group_selectors = inputs.group_selectors;
  group_selectors.assign(targets.groups.size(), 0);
  for (std::size_t place = 0; place < targets.groups.size(); ++place) {
    const Group& group = scene.groups[targets.groups[place]];
    if (!group.enabled.at(frame)) continue;
    group_selectors[place] = static_cast<int>(forces.size());
    selectors.push_back(static_cast<int>(forces.size()));
    forces.push_back(sample_group(scene, group, frame, *inputs.faults, sampling.carriers()));
    inputs.sources.push_back({group.name, "group", group.targets, true});
  }
  for (std::size_t k = 0; k < member_count; ++k) {
    if (selectors[k] < 0) selectors[k] = group_selectors[-1 - selectors[k]];
  }
  return inputs;
}

}  // namespace pliant
