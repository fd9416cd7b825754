#include "pliant/simulation/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/stage_timer.hpp"
#include "pliant/mesh/written/binding.hpp"
#include "pliant/sampling/collider_mesh.hpp"
#include "pliant/sampling/material_maps.hpp"
#include "pliant/sampling/shape_shelf.hpp"
#include "pliant/scene/checks/channel_check.hpp"
#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/checks/sound_things.hpp"
#include "pliant/states/state_key.hpp"

namespace pliant {
namespace {

struct Extent {
  bool is_finite = true;
  double peak_displacement = 0;
};

// Whether all nodes are finite in world space, and their largest distance from rest there. One pass
// over the nodes, in parallel lanes.
Extent extent_of(const Transform& transform, const Field& positions, const Field& rest) {
  constexpr int lanes = 32;
  alignas(64) double largest[lanes] = {};     // squared distance
  alignas(64) double not_finite[lanes] = {};  // 0, or NaN after the first value that is not finite
  const Matrix3d& a = transform.linear;
  const Eigen::Index count = positions.rows();
  for (Eigen::Index first = 0; first < count; first += lanes) {
    const int width = static_cast<int>(std::min<Eigen::Index>(lanes, count - first));
    alignas(64) double squares[lanes] = {};
    for (int k = 0; k < 3; ++k) {
      const double ax = a(k, 0), ay = a(k, 1), az = a(k, 2), moved = transform.translation[k];
      const double* const x = &positions(first, 0);
      const double* const y = &positions(first, 1);
      const double* const z = &positions(first, 2);
      const double* const rest_x = &rest(first, 0);
      const double* const rest_y = &rest(first, 1);
      const double* const rest_z = &rest(first, 2);
      for (int n = 0; n < width; ++n) {
        const double world = (x[n] * ax + y[n] * ay + z[n] * az) + moved;
        const double way =
            (x[n] - rest_x[n]) * ax + (y[n] - rest_y[n]) * ay + (z[n] - rest_z[n]) * az;
        not_finite[n] += world - world;
        squares[n] += way * way;
      }
    }
    for (int n = 0; n < lanes; ++n) largest[n] = squares[n] > largest[n] ? squares[n] : largest[n];
  }
  Extent extent{std::all_of(not_finite, not_finite + lanes, [](double x) { return x == 0; }),
                std::sqrt(*std::max_element(largest, largest + lanes))};
  if (extent.is_finite && !std::isfinite(extent.peak_displacement))  // its square is not finite
    extent.peak_displacement =
        longest_vector((positions - rest) * transform.linear.transpose()).length;
  return extent;
}

std::ptrdiff_t solved_count(const Scene& scene) {
  return std::ranges::count_if(scene.surfaces, [](const Surface& one) { return !one.is_driven(); });
}

}  // namespace

Bodies::Bodies(const Scene& scene, SceneSampling& sampling, const SimulationOptions& options)
    : scene_(scene),
      sampling_(sampling),
      memory_(options.max_memory),
      threads_(options.threads),
      solver_(options.solver),
      exact_parts_(options.exact_parts),
      // Several surfaces are solved in parallel; a single one uses all threads.
      context_{.memory = &memory_,
               .threads = solved_count(scene) == 1 ? &threads_ : nullptr,
               .most_lanes = options.most_lanes,
               .shelf = options.shelf,
               .should_stop = options.should_stop},
      profiles_(options.profile ? scene.surfaces.size() : 0),
      round_done_(options.round_done) {}

std::vector<Error> problems_of(const Scene& scene, const StopRequest& should_stop) {
  std::vector<Error> errors = check_scene(scene, should_stop);
  if (!errors.empty() && scene.fps > 0) {
    const std::vector<Error> more = check_channels_at(scene, scene.start);
    errors.insert(errors.end(), more.begin(), more.end());
  }
  return errors;
}

Result<void> check_to_simulate(const Scene& scene, const StopRequest& should_stop) {
  std::vector<Error> errors = problems_of(scene, should_stop);
  if (scene.surfaces.empty()) {
    errors.push_back({.code = ErrorCode::InvalidInput,
                      .message = "the scene has no surface to simulate",
                      .file = scene.origin.file});
  }
  if (!errors.empty()) return fail(as_one(std::move(errors), scene.origin.file));
  return {};
}

tl::unexpected<Error> interrupted_at_start() {
  return fail(ErrorCode::Interrupted, "interrupted before the first frame");
}

Result<void> Bodies::make_all() {
  const SoundThings known(scene_, context_.shelf);
  std::vector<Error> errors = check_channels(
      scene_, [&](const std::string& name, std::string_view) { return !known.contain(name); },
      context_.should_stop);
  const bool are_sound = errors.empty();
  if (!are_sound && errors.front().code == ErrorCode::Interrupted) return interrupted_at_start();
  if (are_sound) known.add_others();
  std::vector<ReservedShape> shapes;
  for (const Surface& surface : scene_.surfaces) {
    if (context_.is_stopped()) return interrupted_at_start();
    auto made = find_rest_shape(surface, scene_.origin, context_);
    if (!made) {
      if (made.error().code == ErrorCode::Interrupted) return interrupted_at_start();
      errors.push_back(std::move(made.error()));
      continue;
    }
    if (surface.is_animated()) {
      if (auto moves = animate(*made, surface, scene_, context_); !moves)
        errors.push_back(moves.error());
    }
    if (are_sound) {
      for (Error& error : check_against_shape(scene_, surface, made->shape))
        errors.push_back(std::move(error));
    }
    shapes.push_back(*std::move(made));
  }
  read_colliders(errors);
  if (context_.is_stopped() || std::ranges::count(errors, ErrorCode::Interrupted, &Error::code))
    return interrupted_at_start();
  if (errors.empty()) {
    find_drivers();
    auto joined = bind_driven(shapes);
    if (joined) joined = join_forces(shapes);
    if (!joined) {
      if (joined.error().code == ErrorCode::Interrupted) return interrupted_at_start();
      errors.push_back(joined.error());
    }
  }
  if (!errors.empty()) return fail(as_one(std::move(errors), scene_.origin.file));
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    if (!add(scene_.surfaces[k], std::move(shapes[k]))) return interrupted_at_start();
  }
  steps_.resize(bodies_.size());
  keeps_velocities_.resize(bodies_.size());
  cycles_.resize(bodies_.size());
  return {};
}

// Reads the meshes of colliders.
void Bodies::read_colliders(std::vector<Error>& errors) {
  for (std::size_t k = 0; k < scene_.colliders.size() && !context_.is_stopped(); ++k) {
    const Collider& collider = scene_.colliders[k];
    if (!std::holds_alternative<ClosedMesh>(collider.shape)) continue;
    MemoryShare memory(&memory_);
    auto mesh = find_collider_mesh(collider, scene_, context_, memory);
    if (!mesh) {
      errors.push_back(std::move(mesh.error()));
      continue;
    }
    sampling_.tell_mesh(k, *std::move(mesh));
    collider_shares_.push_back(std::move(memory));
  }
}

// The surface that drives each surface; its own index if none does.
void Bodies::find_drivers() {
  std::map<std::string_view, std::size_t> named;
  for (std::size_t k = 0; k < scene_.surfaces.size(); ++k)
    named.emplace(scene_.surfaces[k].name, k);
  for (const Surface& surface : scene_.surfaces)
    drivers_.push_back(named.at(surface.is_driven() ? surface.driven_by : surface.name));
}

Result<void> Bodies::bind_driven(std::span<ReservedShape> made) const {
  for (std::size_t k = 0; k < made.size(); ++k) {
    if (!scene_.surfaces[k].is_driven()) continue;
    if (context_.is_stopped()) return interrupted_at_start();
    auto bound = find_binding(made[k], scene_.surfaces[k], made[drivers_[k]].shape,
                              scene_.surfaces[drivers_[k]], scene_, context_);
    if (!bound) return bound;
  }
  return {};
}

// Finds what forces need of the shapes: the faces of those that are pushed along their normals, and
// the surfaces that are followed.
Result<void> Bodies::join_forces(std::span<ReservedShape> made) const {
  for (std::size_t k = 0; k < made.size(); ++k) {
    const auto& members = sampling_.targets(k).forces;
    const bool use_normals = std::ranges::any_of(members, [&](const auto& member) {
      const Force& force = scene_.forces[member.force];
      return force.along == PushAlong::Normal ||
             std::holds_alternative<PressureChannels>(force.kind);
    });
    if (!use_normals) continue;
    auto found = find_faces(made[k], scene_.surfaces[k], scene_, context_.should_stop);
    if (!found) return found;
  }
  std::vector<std::reference_wrapper<const RestShape>> shapes;
  for (const ReservedShape& one : made) shapes.emplace_back(one.shape);
  const auto carriers = Carriers::make(scene_, shapes, context_.should_stop);
  if (!carriers) return fail(carriers.error());
  const auto meshes = scene_.colliders.empty()
                          ? nullptr
                          : std::make_shared<const ColliderMeshes>(sampling_.meshes());
  for (ReservedShape& one : made) {
    one.shape.carriers = *carriers;
    one.shape.collider_meshes = meshes;
  }
  return {};
}

// Errors: Interrupted.
Result<void> Bodies::add(const Surface& surface, ReservedShape made) {
  RunContext context = context_;
  context.profile = profile_of(bodies_.size());
  BodySettings settings = body_settings(surface, made.shape.grid.has_value());
  settings.exact_parts = exact_parts_;
  sampling_.tell(bodies_.size(), made.shape);
  auto body = make_body(made.shape, settings, solver_, std::move(context));
  if (!body) return fail(body.error());
  bodies_.push_back(*std::move(body));
  rest_shapes_.push_back(std::move(made.shape));
  shares_.push_back(std::move(made.memory));
  return {};
}

void Bodies::add_to(SceneStates& states) const {
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    states.add(rest_key(rest_shapes_[k], bodies_[k]->settings(), solver_));
}

std::vector<Error> Bodies::check_maps(int frame) const {
  std::vector<Error> errors;
  for (std::size_t k = 0; k < rest_shapes_.size(); ++k) {
    for (Error& error : check_maps_at(scene_, scene_.surfaces[k], rest_shapes_[k], frame))
      errors.push_back(std::move(error));
  }
  return errors;
}

// In parallel, unless the threads work on the parts of a single body.
void Bodies::for_each_body(const std::function<void(std::size_t)>& visit) {
  if (!context_.threads) return threads_.for_each(bodies_.size(), visit);
  for (std::size_t k = 0; k < bodies_.size(); ++k) visit(k);
}

void Bodies::step(int frame, SceneStates* states, const std::function<bool()>& give_way) {
  // By reference: a std::function would allocate for so many captures.
  const auto step_one = [&](std::size_t k) { step(k, frame, states); };
  for_each_body(std::ref(step_one));
  const auto lacks_memory = [](const Step& step) {
    return !step.outcome && step.outcome.error().code == ErrorCode::OutOfMemory;
  };
  if (std::any_of(steps_.begin(), steps_.end(), lacks_memory) && give_way && give_way()) {
    for_each_body([&](std::size_t k) {
      if (lacks_memory(steps_[k])) step(k, frame, states);
    });
  }
}

void Bodies::step(std::size_t index, int frame, SceneStates* states) {
  Step& step = steps_[index];
  const Surface& surface = scene_.surfaces[index];
  step.is_solved_now = is_solved_at(scene_, surface, frame);
  step.is_read = false;
  step.is_again = begins_cycle(scene_, surface, frame + 1);
  step.frame = solved_frame(scene_, surface, frame);
  step.outcome = {};
  Body& body = *bodies_[index];
  if (step.is_solved_now) {
    const StageTimer timer(profile_of(index), Stage::Sampling);
    step.inputs = sample_inputs(scene_, sampling_, index, frame, std::move(step.inputs));
  }
  if (step.is_again) {
    // The last solve of a cycle leads to its beginning, but for the gap: it is only told of.
    if (step.is_solved_now) {
      const auto plan = body.look(step.inputs.body);
      if (!plan) {
        step.outcome = fail(plan.error());
        return;
      }
      step.facts = facts_of(step.inputs.body, *plan, surface.solver.combine, std::move(step.facts));
    }
    step.outcome = begin_cycle(index, states);
    return;
  }
  if (!step.is_solved_now) return body.touch_nothing();
  if (states) {
    const StageTimer timer(profile_of(index), Stage::Checkpoints);
    if (context_.is_stopped()) {
      step.outcome = interrupted();
      return;
    }
    if (auto stored = states->read(index, frame, step.inputs, body)) {
      if (keeps_velocities_[index]) step.velocities_before = body.state().velocities;
      body.restore(std::move(stored->state));
      step.facts = std::move(stored->facts);
      step.is_read = true;
      step.outcome = {};
      return;
    }
  }
  step.outcome = body.step(step.inputs.body);
  if (!step.outcome) return;
  step.facts =
      facts_of(step.inputs.body, body.last_step(), surface.solver.combine, std::move(step.facts));
  if (states && step.inputs.faults->first().empty()) {
    const StageTimer timer(profile_of(index), Stage::Checkpoints);
    states->write(index, frame, body, step.facts);
  }
}

RunWatch Bodies::watch() {
  RunWatch watch(scene_, rest_shapes_);
  for (std::size_t k = 0; k < size(); ++k) keeps_velocities_[k] = watch.needs_velocities(k);
  return watch;
}

void Bodies::look(RunWatch& watch, std::size_t surface, int frame, WarningLog& log) const {
  const Step& step = steps_[surface];
  if (step.is_again) return watch.forget_step(surface);
  const Body& body = *bodies_[surface];
  watch.look(surface, frame, step.inputs.body.frame_length, step.facts.is_solved, body,
             step.is_read ? step.velocities_before : body.velocities_before(), log);
}

Result<void> Bodies::outcome(std::size_t index) const {
  const Step& step = steps_[index];
  const Surface& surface = scene_.surfaces[index];
  const bool has_faults = step.is_solved_now && !step.is_again;
  if (std::string fault = has_faults ? step.inputs.faults->first() : std::string();
      !fault.empty()) {
    return fail(located({ErrorCode::NotFinite, std::move(fault)}, surface, step.frame));
  }
  if (!step.outcome) return fail(located(step.outcome.error(), surface, step.frame));
  return {};
}

Result<Frame> Bodies::output(int frame, Frame reuse) {
  reuse.number_ = frame;
  reuse.surfaces_.resize(bodies_.size());
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const StageTimer timer(profile_of(k), Stage::Output);
    if (context_.is_stopped())
      return fail(
          located({.code = ErrorCode::Interrupted, .message = {}}, scene_.surfaces[k], frame));
    if (auto done = show(k, frame, reuse.surfaces_[k]); !done) return fail(done.error());
  }
  return reuse;
}

Result<void> Bodies::show(std::size_t index, int frame, SurfaceFrame& shown) const {
  const RestShape& shape = rest_shapes_[index];
  const Surface& surface = scene_.surfaces[index];
  const Field& nodes = bodies_[index]->state().positions;
  const Transform transform = surface.transform.at(frame);
  Field positions = std::move(shown.object_positions_);
  Field rest = std::move(shown.object_rest_);
  if (shape.binding || shape.animation) {
    auto placed = shape.binding ? driven_positions(index, frame, transform, std::move(positions))
                                : place_vertices(index, frame, nodes, std::move(positions));
    if (!placed) return fail(located(placed.error(), surface, frame));
    positions = *std::move(placed);
  } else {
    auto placed = shape.to_vertices(nodes, std::move(positions), context_.should_stop);
    if (!placed) return fail(located(placed.error(), surface, frame));
    positions = *std::move(placed);
  }
  if (shape.animation) {
    auto at_rest = place_vertices(index, frame, bodies_[index]->rest(), std::move(rest));
    if (!at_rest) return fail(located(at_rest.error(), surface, frame));
    rest = *std::move(at_rest);
  } else {
    rest.resize(0, 3);
  }
  // A vertex moves as its node, if it has one.
  const bool has_nodes = !shape.binding && !shape.weights && !shape.animation;
  const Extent extent =
      has_nodes ? extent_of(transform, nodes, shape.rest)
                : extent_of(transform, positions, shape.animation ? rest : shape.mesh.positions);
  if (!extent.is_finite) {
    return fail(
        located({ErrorCode::NotFinite, "a position in world space is not finite"}, surface, frame));
  }
  shown.name_ = shape.name;
  shown.transform_ = transform;
  shown.peak_displacement_ = extent.peak_displacement;
  shown.object_positions_ = std::move(positions);
  shown.object_rest_ = std::move(rest);
  return {};
}

// The vertices of an animated shape at a frame, displaced as their nodes (#nodes x 3).
Result<Field> Bodies::place_vertices(std::size_t index, int frame, const Field& displacement,
                                     Field reuse) const {
  const RestShape& shape = rest_shapes_[index];
  if (shape.weights) {
    const auto nodes = shape.animation->nodes_at(frame);
    if (!nodes) return fail(nodes.error());
    return shape.to_vertices(**nodes + displacement, std::move(reuse), context_.should_stop);
  }
  const auto vertices = shape.animation->vertices_at(frame);
  if (!vertices) return fail(vertices.error());
  reuse = **vertices;
  StopPoll poll(context_.should_stop);
  for (std::size_t vertex = 0; vertex < shape.vertex_nodes.size(); ++vertex) {
    if (poll.after(4)) return interrupted();
    const int node = shape.vertex_nodes[vertex];
    if (node >= 0) reuse.row(static_cast<Eigen::Index>(vertex)) += displacement.row(node);
  }
  return reuse;
}

// The vertices of a driven surface: its driver's displacement, through the linear parts of both
// transforms. That of an animated driver is from its shape at the scene's start.
Result<Field> Bodies::driven_positions(std::size_t index, int frame, const Transform& transform,
                                       Field reuse) const {
  if (!scene_.surfaces[index].enabled) return rest_shapes_[index].mesh.positions;
  const std::size_t driver = drivers_[index];
  const Body& body = *bodies_[driver];
  Field moved = body.state().positions - body.rest();
  if (const auto& animation = rest_shapes_[driver].animation) {
    const auto now = animation->nodes_at(frame), at_start = animation->nodes_at(scene_.start);
    if (!now || !at_start) return fail(now ? at_start.error() : now.error());
    moved += **now - **at_start;
  }
  auto displaced =
      rest_shapes_[index].binding->displacements(moved, std::move(reuse), context_.should_stop);
  if (!displaced) return displaced;
  Field positions = *std::move(displaced);
  const Transform from = scene_.surfaces[driver].transform.at(frame);
  const Matrix3d linear = inverse_linear(transform) * from.linear;
  StopPoll poll(context_.should_stop);
  for (Eigen::Index k = 0; k < positions.rows(); ++k) {
    if (poll.after(8)) return interrupted();
    const Vector3d displacement = linear * positions.row(k).transpose();
    positions.row(k) = rest_shapes_[index].mesh.positions.row(k) + displacement.transpose();
  }
  return positions;
}

Result<FrameReport> Bodies::report(int frame, ReportDetail detail) {
  std::vector<Result<SurfaceReport>> surfaces(bodies_.size());
  for_each_body([&](std::size_t k) {
    if (!is_solved_at(scene_, scene_.surfaces[k], frame)) {
      surfaces[k]->is_surface = !rest_shapes_[k].grid;
    } else {
      surfaces[k] = report_of(*bodies_[k], sample_inputs(scene_, sampling_, k, frame), detail);
      if (surfaces[k]) surfaces[k]->frame = solved_frame(scene_, scene_.surfaces[k], frame);
    }
    if (surfaces[k]) surfaces[k]->contacts = bodies_[k]->state().contacts;
  });
  FrameReport report{frame, {}};
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!surfaces[k]) return fail(located(surfaces[k].error(), scene_.surfaces[k], frame));
    report.surfaces.push_back(*std::move(surfaces[k]));
  }
  return report;
}

void Bodies::reset() {
  for (const auto& body : bodies_) body->reset();
}

void Bodies::restore(std::vector<BodyState> states) {
  for (std::size_t k = 0; k < bodies_.size(); ++k) bodies_[k]->restore(std::move(states[k]));
}

std::vector<BodyState> Bodies::states(std::vector<BodyState> reuse) const {
  reuse.resize(bodies_.size());
  for (std::size_t k = 0; k < bodies_.size(); ++k) reuse[k] = bodies_[k]->state();
  return reuse;
}

// The error with its surface and frame.
Error Bodies::located(Error error, const Surface& surface, int frame) const {
  // No surface caused an interruption.
  if (error.code == ErrorCode::Interrupted) return with_frame(std::move(error), frame);
  error.message = fmt::format("surface \"{}\", frame {}: {}", surface.name, frame, error.message);
  return scene_.origin.located(std::move(error), scene_.origin.at(surface.name));
}

Profile* Bodies::profile_of(std::size_t surface) {
  return profiles_.empty() ? nullptr : &profiles_[surface];
}

Profile Bodies::profile() const {
  Profile all;
  for (const Profile& profile : profiles_) all.add(profile);
  return all;
}

std::size_t Bodies::surface_memory() const {
  std::size_t bytes = 0;
  for (const auto* const shares : {&shares_, &collider_shares_})
    for (const MemoryShare& share : *shares) bytes += share.bytes();
  return bytes;
}

SolverCounts Bodies::solver_counts() const {
  SolverCounts total;
  for (const auto& body : bodies_) total = total + body->solver_counts();
  return total;
}

}  // namespace pliant
