#include "pliant/feedback/surface_previewer.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pliant/body/step_facts.hpp"

namespace pliant {
namespace {

constexpr double shared_nodes = 1e8;  // solved for shares, per preview

}  // namespace

// The cases of a surface, in the order of the results.
std::vector<PreviewCase> cases_of(const Scene& scene, const RestShape& shape, std::size_t index) {
  const Surface& surface = scene.surfaces[index];
  std::vector<std::size_t> all_forces, all_groups;
  std::vector<PreviewCase> cases;
  const auto add = [&](Preview::Of of, std::size_t which, std::vector<std::size_t> forces,
                       const std::vector<std::size_t>& groups) {
    Preview preview;
    preview.surface = index;
    preview.of = of;
    preview.index = which;
    cases.push_back(
        {std::move(preview), {scene, surface, std::move(forces), groups, shape.animation}});
  };
  std::map<std::string_view, std::size_t> group_named;
  for (std::size_t k = 0; k < scene.groups.size(); ++k) {
    group_named.emplace(scene.groups[k].name, k);
    const auto& targets = scene.groups[k].targets;
    if (targets.empty() ||
        std::find(targets.begin(), targets.end(), surface.name) != targets.end()) {
      all_groups.push_back(k);
    }
  }
  std::vector<std::vector<std::size_t>> members(scene.groups.size());
  for (std::size_t k = 0; k < scene.forces.size(); ++k) {
    const Force& force = scene.forces[k];
    const auto group = group_named.find(force.group);
    const bool has_group = group != group_named.end();
    if (!targets(force, has_group ? &scene.groups[group->second] : nullptr, surface.name)) continue;
    all_forces.push_back(k);
    if (has_group) members[group->second].push_back(k);
    add(Preview::Of::Force, k, {k},
        has_group ? std::vector<std::size_t>{group->second} : std::vector<std::size_t>{});
  }
  for (const std::size_t group : all_groups) {
    if (!members[group].empty()) add(Preview::Of::Group, group, members[group], {group});
  }
  const bool is_whole = surface.solver.region == SolvedRegion::All;
  if (is_whole || !all_forces.empty() || !all_groups.empty()) {
    add(Preview::Of::All, 0, std::move(all_forces), all_groups);
  }
  return cases;
}

// Whether the case acts at some frame.
bool has_frames(const PreviewCase& one, const Scene& scene) {
  const Surface& surface = scene.surfaces[one.preview.surface];
  for (int frame = first_solved_frame(scene, surface); frame <= scene.end; ++frame) {
    if (!is_solved_at(scene, surface, frame)) continue;
    if (one.preview.of == Preview::Of::All ? one.acting.selects_at(frame)
                                           : !one.acting.enabled_at(frame).empty()) {
      return true;
    }
  }
  return false;
}

SurfacePreviewer::SurfacePreviewer(const Scene& scene, const Surface& surface,
                                   const RestShape& rest_shape, double most_searched,
                                   const RunContext& context)
    : scene_(scene),
      surface_(surface),
      body_(rest_shape, surface_, 1 / scene_.fps, context),
      first_(first_solved_frame(scene_, surface_)),
      last_(surface_.solver.loop ? first_ + *surface_.solver.loop - 1
                                 : std::max(first_, scene_.end - 1)),
      most_frames_(std::max(4.0, most_searched / body_.node_count())) {}

Result<void> SurfacePreviewer::look(PreviewCase& one) {
  Preview& preview = one.preview;
  if (auto sized = body_.reserve(); !sized) return sized;
  const std::vector<int> frames = frames_of(one);
  for (const int frame : frames) {
    if (auto looked = look_at(one, frame); !looked) return located(looked.error(), frame);
  }
  if (!preview.frame) {
    if (preview.of == Preview::Of::All) return {};
    for (const int frame : frames) {
      const BodyInputs inputs = inputs_of(one, frame);
      if (inputs.forces.empty()) continue;
      // The last one selects: the region of a group follows its forces.
      const auto [to_vertex, to_centre] = body_.distances(inputs, inputs.forces.back());
      const double radius = inputs.forces.back().deformation_radius;
      const bool is_nearer =
          !preview.gap ||
          to_vertex - radius < preview.gap->to_vertex - preview.gap->deformation_radius;
      if (is_nearer) preview.gap = {frame, to_vertex, to_centre, radius};
      if (auto sound = body_.check_faults(); !sound) return located(sound.error(), frame);
    }
    return {};
  }
  if (auto told = tell(one); !told) return located(told.error(), *preview.frame);
  return {};
}

Result<void> SurfacePreviewer::play(PreviewCase& one, double& nodes_left) {
  if (surface_.solver.loop) return {};  // a cycle is not what the first frames show
  if (nodes_left < body_.least_cost() * (scene_.end - first_)) return {};
  PlayedPeak played{0, scene_.start};
  const bool is_plain = one.preview.of != Preview::Of::All;
  body_.begin(is_plain);
  for (int frame = first_; frame < scene_.end; ++frame) {
    if (is_solved_at(scene_, surface_, frame)) {
      const BodyInputs inputs = inputs_of(one, frame);
      auto stepped = body_.step(inputs);
      if (!stepped) return located(stepped.error(), frame);
      nodes_left -= *stepped;
      if (nodes_left <= 0) return {};
    }
    if (frame + 1 < scene_.start) continue;  // of the preroll, which is not shown
    const Transform shown = surface_.transform.at(frame + 1);
    const double peak = body_.peak(shown).size;
    if (peak > played.peak) played = {peak, frame + 1};
  }
  one.preview.played = played;
  return {};
}

BodyInputs SurfacePreviewer::inputs_of(const PreviewCase& one, int frame) {
  return one.acting.at(frame, body_.faults());
}

// The frames at which the case may have its greatest effect; if there are many, evenly spaced
// ones.
std::vector<int> SurfacePreviewer::frames_of(PreviewCase& one) {
  Preview& preview = one.preview;
  const bool is_force = preview.of == Preview::Of::Force;
  std::vector<int> enabled;
  bool has_magnitude = false;
  for (int frame = first_; frame <= last_; ++frame) {
    if (!is_solved_at(scene_, surface_, frame)) continue;
    if (is_force ? !one.acting.is_enabled(preview.index, frame) : !one.acting.selects_at(frame)) {
      continue;
    }
    enabled.push_back(frame);
    if (!is_force) continue;
    const double magnitude = scene_.forces[preview.index].magnitude.at(frame)[0];
    if (!has_magnitude || std::abs(magnitude) > std::abs(preview.largest_magnitude)) {
      preview.largest_magnitude = magnitude;
      preview.largest_magnitude_frame = frame;
    }
    has_magnitude = true;
  }
  if (enabled.empty()) return {};
  if (is_force && one.acting.stand_still()) return {preview.largest_magnitude_frame};
  const auto count = static_cast<double>(enabled.size());
  preview.is_every_frame = count <= most_frames_;
  if (preview.is_every_frame) return enabled;
  std::vector<int> frames;
  const double step = count / std::floor(most_frames_);
  for (double place = 0; place < count; place += step) {
    frames.push_back(enabled[static_cast<std::size_t>(place)]);
  }
  frames.push_back(is_force ? preview.largest_magnitude_frame : enabled.back());
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

// Sets the case's frame to this one if its effect is the greatest so far.
Result<void> SurfacePreviewer::look_at(PreviewCase& one, int frame) {
  Preview& preview = one.preview;
  const BodyInputs inputs = inputs_of(one, frame);
  const bool is_plain = preview.of != Preview::Of::All;
  const auto step = body_.look(inputs, is_plain);
  if (!step) return fail(step.error());
  if (!step->selects()) return {};
  double peak = 0;
  const int unknowns = step->unknown_count();
  if (unknowns > 0 && unknowns <= most_previewed_unknowns && step->is_held()) {
    if (auto settled = body_.settle(inputs, is_plain); !settled) return fail(settled.error());
    peak = body_.peak(inputs.transform).size;
  }
  if (!preview.frame || peak > preview.static_peak) {
    preview.frame = frame;
    preview.static_peak = peak;
  }
  return {};
}

// Fills in the results at the frame of greatest effect.
Result<void> SurfacePreviewer::tell(PreviewCase& one) {
  Preview& preview = one.preview;
  const BodyInputs inputs = inputs_of(one, *preview.frame);
  const bool is_plain = preview.of != Preview::Of::All;
  auto step = body_.look(inputs, is_plain);
  if (!step) return fail(step.error());
  if (preview.of == Preview::Of::Force) {
    preview.magnitude = scene_.forces[preview.index].magnitude.at(*preview.frame)[0];
  }
  preview.selected = step->selection.box();
  std::vector<Box> room;
  preview.is_apart = !is_plain && surface_.solver.combine == Combine::Box &&
                     !scene_.origin.gives(surface_.name, "combine") &&
                     falls_apart(step->selection, room);
  const int unknowns = step->unknown_count();
  preview.is_solvable = unknowns > 0;
  preview.is_held = step->is_held();
  preview.is_solved = preview.is_solvable && preview.is_held && unknowns <= most_previewed_unknowns;
  if (preview.is_solved) {
    if (auto settled = body_.settle(inputs, is_plain); !settled) return fail(settled.error());
  }
  preview.regions = regions_of(*step);
  for (std::size_t k = 0; k < preview.regions.size(); ++k) {
    RegionPreview& region = preview.regions[k];
    preview.counts = preview.counts + region.counts;
    const bool is_free = preview.is_solvable && !preview.is_held && region.is_solvable &&
                         unknowns <= most_factored_unknowns && inputs.dynamics.density > 0;
    one.motions.emplace_back();
    const bool is_settled = preview.is_solved && region.is_solvable;
    if (!is_free && !is_settled) continue;
    auto moving = is_free ? body_.unheld_vibration(inputs, *step, k, std::move(region))
                          : body_.vibrations(inputs, *step, k, std::move(region));
    if (!moving) return fail(moving.error());
    region = std::move(moving->preview);
    one.motions.back() = std::move(moving->motion);
  }
  if (preview.is_solved && preview.of != Preview::Of::Force) {
    return share(one, inputs, unknowns);
  }
  return {};
}

// Computes the share of each force in the peak. Requires: the body is settled under all of them.
Result<void> SurfacePreviewer::share(PreviewCase& one, const BodyInputs& inputs, int unknowns) {
  Preview& preview = one.preview;
  const std::vector<std::size_t> enabled = one.acting.enabled_at(*preview.frame);
  if (preview.static_peak == 0 || static_cast<double>(enabled.size()) * unknowns > shared_nodes)
    return {};
  const PreviewBody::Peak peak = body_.peak(inputs.transform);
  for (std::size_t k = 0; k < enabled.size(); ++k) {
    BodyInputs alone = inputs;
    for (std::size_t other = 0; other < alone.forces.size(); ++other) {
      if (other != k) alone.forces[other].magnitude = 0;
    }
    if (auto settled = body_.settle(alone, true); !settled) return fail(settled.error());
    const Vector3d way = body_.displacement(inputs.transform, peak.node);
    preview.shares.push_back({enabled[k], way.dot(peak.way) / (peak.size * peak.size)});
  }
  return {};
}

tl::unexpected<Error> SurfacePreviewer::located(Error error, int frame) const {
  if (error.code == ErrorCode::Interrupted) return fail(std::move(error));
  error.message = fmt::format("surface \"{}\", frame {}: {}", surface_.name, frame, error.message);
  return fail(scene_.origin.located(std::move(error), scene_.origin.line_of(surface_.name)));
}

}  // namespace pliant
