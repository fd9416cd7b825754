#include "pliant/scene/scene.hpp"

#include <algorithm>
#include <utility>

#include "pliant/scene/format/description.hpp"
#include "pliant/scene/text/source_map.hpp"

namespace pliant {
namespace {

const ScenePart* find_part(const std::vector<ScenePart>& parts, std::string_view name) {
  const auto found = std::ranges::lower_bound(parts, name, {}, &ScenePart::name);
  return found != parts.end() && found->name == name ? &*found : nullptr;
}

}  // namespace

namespace {

Vector3d vector_at(const Channel<3>& channel, double frame) {
  const Value<3> value = channel.at(frame);
  return {value[0], value[1], value[2]};
}

}  // namespace

Transform TransformChannels::at(double frame) const {
  return make_transform(vector_at(translate, frame), vector_at(rotate, frame),
                        vector_at(scale, frame), rotate_order);
}

Placement TransformChannels::placement_at(double frame) const {
  return {vector_at(translate, frame), vector_at(rotate, frame), vector_at(scale, frame),
          rotate_order};
}

Matrix3d TransformChannels::rotation_at(double frame) const {
  return make_transform(Vector3d::Zero(), vector_at(rotate, frame), Vector3d::Ones(), rotate_order)
      .linear;
}

bool operator==(const Scene& a, const Scene& b) {
  const auto& [fps, start, end, seed, surfaces, forces, groups, colliders, origin, notes] = b;
  return a.fps == fps && a.start == start && a.end == end && a.seed == seed &&
         a.surfaces == surfaces && a.forces == forces && a.groups == groups &&
         a.colliders == colliders;
}

std::string_view kind_of(const Force& force) {
  return std::visit([]<class Kind>(const Kind&) { return Description<Kind>::element; }, force.kind);
}

std::string_view shape_of(const Collider& collider) {
  return std::visit([]<class Kind>(const Kind&) { return Description<Kind>::element; },
                    collider.shape);
}

bool is_name(std::string_view text) {
  const auto is_first = [](char c) {
    return c == '_' || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  const auto is_later = [&](char c) { return is_first(c) || c == '-' || (c >= '0' && c <= '9'); };
  return !text.empty() && text.size() <= longest_object_name && is_first(text.front()) &&
         std::all_of(text.begin(), text.end(), is_later);
}

void SceneOrigin::rename(const std::string& name) {
  file = name;
  if (!sources) return;
  SourceMap renamed = *sources;
  renamed.rename(name);
  sources = std::make_shared<SourceMap>(std::move(renamed));
}

TextPlace SceneOrigin::at(const std::string& name, const std::string& attribute) const {
  if (!sources) return {};
  const ScenePart* part = find_part(parts, name + '.' + attribute);
  if (!part) part = find_part(parts, name);
  return part ? part->place : TextPlace{};
}

TextPlace SceneOrigin::last_of(const std::string& name,
                               const std::vector<std::string>& attributes) const {
  TextPlace last;
  for (const std::string& attribute : attributes) {
    const TextPlace place = at(name, attribute);
    if (!last.is_known() || (place.is_known() && sources->is_before(last, place))) last = place;
  }
  return last;
}

ScenePlace SceneOrigin::place_of(const TextPlace& place) const {
  return sources ? sources->place_of(place) : ScenePlace{{}, file};
}

bool SceneOrigin::is_own(const std::string& name, const std::string& attribute) const {
  return at(name, attribute).text <= 0;
}

Error SceneOrigin::located(Error error, const TextPlace& place) const {
  if (sources) return sources->located(std::move(error), place);
  error.file = file;
  return error;
}

bool SceneOrigin::gives(const std::string& name, const std::string& attribute) const {
  return find_part(parts, name + '.' + attribute) != nullptr;
}

double frame_length(const Scene& scene, const Surface& surface, int frame) {
  // 1/dt^2, and forces of inertia of this size, stay finite.
  constexpr double least = 1e-30;
  const double length = surface.solver.time_scale.at(frame)[0] / scene.fps;
  return length >= least ? length : 0;
}

int first_solved_frame(const Scene& scene, const Surface& surface) {
  const SolverSettings& solver = surface.solver;
  return std::max(scene.start, solver.start_frame.value_or(scene.start)) - solver.preroll;
}

FrameSpan sampled_frames(const Scene& scene, const Surface& surface) {
  FrameSpan frames{scene.start, scene.end};
  if (!surface.enabled || surface.is_driven()) return frames;
  const int first = first_solved_frame(scene, surface);
  frames.first = std::min(frames.first, first);
  const std::optional<int> loop = surface.solver.loop;
  if (loop && first <= scene.end) frames.last = std::max(frames.last, first + *loop - 1);
  return frames;
}

FrameSpan sampled_frames(const Scene& scene) {
  FrameSpan all{scene.start, scene.end};
  for (const Surface& surface : scene.surfaces) {
    const FrameSpan frames = sampled_frames(scene, surface);
    all = {std::min(all.first, frames.first), std::max(all.last, frames.last)};
  }
  return all;
}

}  // namespace pliant
