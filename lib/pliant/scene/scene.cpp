#include "pliant/scene/scene.hpp"

#include <algorithm>
#include <utility>

#include "pliant/scene/format/description.hpp"

namespace pliant {
namespace {

/// The line of a part, 0 if it is not in the file.
int find_line(const std::vector<SceneLine>& lines, const std::string& part) {
  const auto found = std::lower_bound(
      lines.begin(), lines.end(), part,
      [](const SceneLine& line, const std::string& wanted) { return line.part < wanted; });
  return found != lines.end() && found->part == part ? found->line : 0;
}

}  // namespace

Transform TransformChannels::at(double frame) const {
  const auto vector = [frame](const Channel<3>& channel) {
    const Value<3> value = channel.at(frame);
    return Vector3d(value[0], value[1], value[2]);
  };
  return make_transform(vector(translate), vector(rotate), vector(scale), rotate_order);
}

bool operator==(const Scene& a, const Scene& b) {
  const auto& [fps, start, end, seed, surfaces, forces, groups, origin, notes] = b;
  return a.fps == fps && a.start == start && a.end == end && a.seed == seed &&
         a.surfaces == surfaces && a.forces == forces && a.groups == groups;
}

std::string_view kind_of(const Force& force) {
  return std::visit([]<class Kind>(const Kind&) { return Description<Kind>::element; }, force.kind);
}

void SceneOrigin::rename(const std::string& name) {
  file = name;
  if (files) files->rename(name);
}

ScenePlace SceneOrigin::place_at(int line) const {
  return files ? files->place_of(line) : ScenePlace{file, line};
}

ScenePlace SceneOrigin::place_of(const std::string& name, const std::string& attribute) const {
  return place_at(line_of(name, attribute));
}

bool SceneOrigin::is_own(const std::string& name, const std::string& attribute) const {
  return !files || files->text_of(line_of(name, attribute)) == 0;
}

Error SceneOrigin::located(Error error, int line) const {
  ScenePlace place = place_at(line);
  error.message = place.told(std::move(error.message));
  error.file = std::move(place.file);
  error.line = place.line;
  return error;
}

int SceneOrigin::line_of(const std::string& name, const std::string& attribute) const {
  if (gives(name, attribute)) return find_line(lines, name + '.' + attribute);
  return find_line(lines, name);
}

int SceneOrigin::last_line_of(const std::string& name,
                              const std::vector<std::string>& attributes) const {
  int line = 0;
  for (const std::string& attribute : attributes) line = std::max(line, line_of(name, attribute));
  return line;
}

bool SceneOrigin::gives(const std::string& name, const std::string& attribute) const {
  return find_line(lines, name + '.' + attribute) != 0;
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
