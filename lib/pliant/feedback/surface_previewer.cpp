#include "pliant/feedback/surface_previewer.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pliant/body/cycle.hpp"
#include "pliant/body/step_facts.hpp"
#include "pliant/sampling/targets.hpp"

namespace pliant {
namespace {

constexpr double shared_nodes = 1e8;  // solved for shares, per preview

// The colliders that target a surface and are not disabled at all frames.
std::vector<std::size_t> colliders_of(const Scene& scene, const Surface& surface) {
  const auto place = std::ranges::find(scene.surfaces, surface.name, &Surface::name);
  std::vector<std::size_t> found =
      targets_of(scene)[static_cast<std::size_t>(place - scene.surfaces.begin())].colliders;
  std::erase_if(found, [&](std::size_t k) {
    const auto& enabled = scene.colliders[k].enabled;
    return !enabled.is_animated() && !enabled.at(scene.start);
  });
  return found;
}

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
    cases.push_back({std::move(preview), {scene, surface, std::move(forces), groups, &shape}});
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

PreviewCase* find_together(std::vector<PreviewCase>& cases) {
  const bool is_there = !cases.empty() && cases.back().preview.of == Preview::Of::All;
  return is_there ? &cases.back() : nullptr;
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
                                   const RunContext& context, PreviewDepth depth)
    : scene_(scene),
      surface_(surface),
      shape_(rest_shape),
      depth_(depth),
      progressed_(context.progressed),
      body_(rest_shape, surface_, 1 / scene_.fps, depth == PreviewDepth::Whole, context),
      first_(first_solved_frame(scene_, surface_)),
      last_(surface_.solver.loop ? first_ + *surface_.solver.loop - 1
                                 : std::max(first_, scene_.end - 1)),
      colliders_(colliders_of(scene_, surface_)),
      most_frames_(std::max(4.0, most_searched / body_.node_count())) {}

void SurfacePreviewer::report(std::string_view work, int done, int count) const {
  if (progressed_) progressed_(fmt::format("{} \"{}\"", work, surface_.name), done, count);
}

bool SurfacePreviewer::answers_in_proportion(const PreviewCase& one) const {
  return !surface_.material.yield && (one.preview.of != Preview::Of::All || is_plain(surface_));
}

bool SurfacePreviewer::plays_in_proportion(const PreviewCase& one) const {
  const BodySettings settings = body_settings(surface_, shape_.grid.has_value());
  return answers_in_proportion(one) && colliders_.empty() && settings.measure == Measure::Rest &&
         settings.release == Release::Freeze;
}

bool SurfacePreviewer::is_hidden_by_rounding(double peak) const {
  const double farthest = shape_.rest.size() > 0 ? shape_.rest.cwiseAbs().maxCoeff() : 0;
  return !(peak > 1e-6 * farthest);
}

Result<void> SurfacePreviewer::look(PreviewCase& one) {
  Preview& preview = one.preview;
  if (auto sized = body_.reserve(); !sized) return sized;
  const std::vector<int> frames = frames_of(one);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    report("looking at the frames of", static_cast<int>(k), static_cast<int>(frames.size()));
    if (auto looked = look_at(one, frames[k]); !looked) return located(looked.error(), frames[k]);
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

Result<void> SurfacePreviewer::look_again(PreviewCase& one, const PreviewCase& before) {
  const bool is_stronger = before.preview.static_peak > 0 || !before.preview.is_solved;
  if (!before.preview.frame || !is_stronger || !answers_in_proportion(one)) return look(one);
  Preview& preview = one.preview;
  if (auto sized = body_.reserve(); !sized) return sized;
  frames_of(one);  // for the largest magnitude
  preview.frame = before.preview.frame;
  preview.is_every_frame = before.preview.is_every_frame;
  preview.static_peak = before.preview.static_peak;
  if (auto told = tell(one, &before); !told) return located(told.error(), *preview.frame);
  return {};
}

Result<void> SurfacePreviewer::play(PreviewCase& one, double& nodes_left, double until) {
  if (nodes_left < body_.least_cost() * (scene_.end - first_)) return {};
  if (auto sized = body_.reserve(); !sized) return sized;
  PlayedPeak played{0, scene_.start};
  body_.begin(one.preview.of != Preview::Of::All);
  const bool is_loop = surface_.solver.loop && first_ <= scene_.end;
  if (is_loop) {
    const auto begun = begin_cycle(one);
    if (!begun) return fail(begun.error());
    if (!*begun) return {};
    played = {body_.shown_peak(surface_.transform.at(first_)), first_};
  }
  if (!is_loop && plays_in_proportion(one)) {
    const auto responded = play_response(one);
    if (!responded) return fail(responded.error());
    if (*responded) {
      nodes_left -= body_.response_cost();
      one.preview.played = **responded;
      return {};
    }
  }
  for (int frame = first_; frame < scene_.end && played.peak <= until; ++frame) {
    report("playing", frame - first_, scene_.end - first_);
    if (is_loop && begins_cycle(scene_, surface_, frame + 1)) {
      body_.return_to_cycle();
    } else if (is_solved_at(scene_, surface_, frame)) {
      auto stepped = body_.step(played_inputs_of(one, solved_frame(scene_, surface_, frame)));
      if (!stepped) return located(stepped.error(), frame);
      nodes_left -= *stepped;
      if (nodes_left <= 0) return {};
    }
    if (frame + 1 < scene_.start) continue;  // of the preroll, which is not shown
    const double peak = body_.shown_peak(surface_.transform.at(frame + 1));
    if (peak > played.peak) played = {peak, frame + 1};
  }
  one.preview.played = played;
  return {};
}

// The peak of an animation in proportion to its loads, without its steps; null: they are needed.
Result<std::optional<PlayedPeak>> SurfacePreviewer::play_response(PreviewCase& one) {
  using Played = std::optional<PlayedPeak>;
  std::vector<FrameToPlay> frames;
  for (int frame = first_; frame < scene_.end; ++frame) {
    if (!is_solved_at(scene_, surface_, frame)) return Played();
    frames.push_back({inputs_of(one, frame), surface_.transform.at(frame + 1)});
  }
  const auto peaks = body_.response_peaks(frames);
  if (!peaks && peaks.error().code == ErrorCode::Interrupted) return fail(peaks.error());
  if (!peaks) body_.faults()->clear();  // the steps tell at which frame it is
  if (!peaks || !*peaks) return Played();
  PlayedPeak played{0, scene_.start};
  for (int frame = std::max(first_, scene_.start - 1); frame < scene_.end; ++frame) {
    const double peak = (**peaks)[static_cast<std::size_t>(frame - first_)];
    if (peak > played.peak) played = {peak, frame + 1};
  }
  if (is_hidden_by_rounding(played.peak)) return Played();
  return Played(played);
}

// Puts the body at the beginning of its cycle; false: it has none.
Result<bool> SurfacePreviewer::begin_cycle(PreviewCase& one) {
  const int frames = *surface_.solver.loop;
  int round = 0, at = first_;
  const auto begun = body_.begin_cycle(frames, [&](int frame) -> Result<void> {
    if (frame == 0) report("looking for the cycle of", ++round, max_rounds);
    at = first_ + frame;
    if (!is_solved_at(scene_, surface_, at)) return {};
    const auto stepped = body_.step(played_inputs_of(one, at));
    if (!stepped) return fail(stepped.error());
    return {};
  });
  if (begun) return true;
  if (begun.error().code != ErrorCode::SolverFailed) return located(begun.error(), at);
  one.open_cycle = begun.error().message;
  return false;
}

BodyInputs SurfacePreviewer::inputs_of(const PreviewCase& one, int frame) {
  return one.acting.at(frame, body_.faults());
}

// The same as it is played: with what stops the surface.
BodyInputs SurfacePreviewer::played_inputs_of(const PreviewCase& one, int frame) {
  BodyInputs inputs = inputs_of(one, frame);
  if (colliders_.empty()) return inputs;
  MetColliders met{.colliders = colliders_, .animation = shape_.animation.get()};
  if (shape_.collider_meshes) met.meshes = *shape_.collider_meshes;
  sample_colliders(scene_, surface_, met, frame, inputs, *body_.faults());
  return inputs;
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
  if (one.acting.stand_still() && answers_in_proportion(one)) return strongest_of(one, enabled);
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

// Of frames between which only magnitudes differ, by a factor, the strongest: others have no
// greater effect.
std::vector<int> SurfacePreviewer::strongest_of(const PreviewCase& one,
                                                const std::vector<int>& frames) const {
  struct Strongest {
    double size = -1;
    int frame = 0;
  };
  std::map<std::pair<std::vector<std::size_t>, std::vector<double>>, Strongest> strongest;
  for (const int frame : frames) {
    std::vector<std::size_t> acting = one.acting.enabled_at(frame);
    std::vector<double> shares;
    double size = 0;
    for (const std::size_t force : acting) {
      const double magnitude = scene_.forces[force].magnitude.at(frame)[0];
      size = std::abs(magnitude) > std::abs(size) ? magnitude : size;
      shares.push_back(magnitude);
    }
    for (double& share : shares) share = size != 0 ? share / size : 0;
    for (const std::size_t group : one.acting.groups_at(frame))
      acting.push_back(scene_.forces.size() + group);
    Strongest& known = strongest[{std::move(acting), std::move(shares)}];
    if (std::abs(size) > known.size) known = {std::abs(size), frame};
  }
  std::vector<int> found;
  for (const auto& [key, each] : strongest) found.push_back(each.frame);
  std::sort(found.begin(), found.end());
  return found;
}

// The peak under loads that are those of the last settled frame times a factor; null: they are not.
std::optional<double> SurfacePreviewer::peak_in_proportion(const BodyInputs& inputs,
                                                           const StepPlan& step) const {
  if (!step.surface || !settled_ || !(settled_->stiffness == inputs.stiffness) ||
      settled_->poisson != inputs.poisson || settled_->goal != inputs.goal ||
      settled_->linear != inputs.transform.linear ||
      !(settled_->level_set == step.surface->level_set))
    return {};
  constexpr double rounding = 1e-12;
  double square = 0, product = 0, size = 0, rest = 0;
  const std::vector<Field>& now = step.surface->loads;
  for (std::size_t k = 0; k < now.size(); ++k) {
    square += settled_->loads[k].squaredNorm();
    product += settled_->loads[k].cwiseProduct(now[k]).sum();
  }
  const double factor = product / square;
  for (std::size_t k = 0; k < now.size(); ++k) {
    size += now[k].squaredNorm();
    rest += (now[k] - factor * settled_->loads[k]).squaredNorm();
  }
  if (!(rest <= rounding * rounding * size)) return {};
  return std::abs(factor) * settled_->peak;
}

// Sets the case's frame to this one if its effect is the greatest so far.
Result<void> SurfacePreviewer::look_at(PreviewCase& one, int frame) {
  Preview& preview = one.preview;
  const BodyInputs inputs = inputs_of(one, frame);
  const bool is_plain = preview.of != Preview::Of::All;
  const auto looked = body_.look(inputs, is_plain);
  if (!looked) return fail(looked.error());
  const StepPlan& step = **looked;
  if (!step.selects()) return {};
  double peak = 0;
  const int unknowns = step.unknown_count();
  const bool is_still = answers_in_proportion(one) && has_no_load(step);
  if (unknowns > 0 && unknowns <= most_previewed_unknowns && step.is_held() && !is_still) {
    const auto known = answers_in_proportion(one) ? peak_in_proportion(inputs, step) : std::nullopt;
    if (!known) {
      if (auto settled = body_.settle(inputs, is_plain); !settled) return fail(settled.error());
      peak = body_.peak(inputs.transform).size;
      if (step.surface) settled_.emplace(inputs, *step.surface, peak);
    } else {
      peak = *known;
    }
  }
  if (!preview.frame || peak > preview.static_peak) {
    preview.frame = frame;
    preview.static_peak = peak;
  }
  return {};
}

// Fills in the results at the frame of greatest effect. `before`: of the same effect, times a
// factor.
Result<void> SurfacePreviewer::tell(PreviewCase& one, const PreviewCase* before) {
  Preview& preview = one.preview;
  const BodyInputs inputs = inputs_of(one, *preview.frame);
  const bool is_plain = preview.of != Preview::Of::All;
  const auto looked = body_.look(inputs, is_plain);
  if (!looked) return fail(looked.error());
  const StepPlan& step = **looked;
  if (preview.of == Preview::Of::Force) {
    preview.magnitude = scene_.forces[preview.index].magnitude.at(*preview.frame)[0];
  }
  preview.selected = step.selection.box();
  std::vector<Box> room;
  preview.is_apart = !is_plain && surface_.solver.combine == Combine::Box &&
                     !scene_.origin.gives(surface_.name, "combine") &&
                     falls_apart(step.selection, room);
  const int unknowns = step.unknown_count();
  preview.is_solvable = unknowns > 0;
  preview.is_held = step.is_held();
  preview.is_solved = preview.is_solvable && preview.is_held && unknowns <= most_previewed_unknowns;
  if (preview.is_solved) {
    if (auto settled = body_.settle(inputs, is_plain); !settled) return fail(settled.error());
    preview.static_peak = body_.peak(inputs.transform).size;
  }
  preview.regions = regions_of(step);
  for (std::size_t k = 0; k < preview.regions.size(); ++k) {
    RegionPreview& region = preview.regions[k];
    preview.counts = preview.counts + region.counts;
    const bool is_free = preview.is_solvable && !preview.is_held && region.is_solvable &&
                         unknowns <= most_vibrating_nodes && inputs.dynamics.density > 0;
    one.motions.emplace_back();
    const bool is_settled = preview.is_solved && region.is_solvable;
    if (!is_free && !is_settled) continue;
    const RegionMotion* const known =
        before && k < before->motions.size() && before->motions[k] ? &*before->motions[k] : nullptr;
    report("finding the vibrations of", static_cast<int>(k),
           static_cast<int>(preview.regions.size()));
    auto moving = is_free ? body_.unheld_vibration(inputs, step, k, std::move(region), known)
                          : body_.vibrations(inputs, step, k, std::move(region), known);
    if (!moving) return fail(moving.error());
    region = std::move(moving->preview);
    if (known) region.solver_memory = before->preview.regions[k].solver_memory;
    one.motions.back() = std::move(moving->motion);
  }
  if (before) preview.shares = before->preview.shares;
  const bool has_shares = preview.is_solved && preview.of != Preview::Of::Force && !before;
  if (!has_shares || depth_ == PreviewDepth::Slowest) return {};
  return share(one, inputs, step);
}

// Computes the share of each force in the peak. Requires: the body is settled under all of them;
// `step` is its plan.
Result<void> SurfacePreviewer::share(PreviewCase& one, const BodyInputs& inputs,
                                     const StepPlan& step) {
  Preview& preview = one.preview;
  const std::vector<std::size_t> enabled = one.acting.enabled_at(*preview.frame);
  const double nodes = static_cast<double>(enabled.size()) * step.unknown_count();
  if (preview.static_peak == 0 || nodes > shared_nodes) return {};
  const PreviewBody::Peak peak = body_.peak(inputs.transform);
  const SingleForces single(inputs, body_.selecting(inputs, step));
  for (std::size_t k = 0; k < enabled.size(); ++k) {
    if (auto settled = body_.settle(single.of(k), true); !settled) return fail(settled.error());
    const Vector3d way = body_.displacement(inputs.transform, peak.node);
    preview.shares.push_back({enabled[k], way.dot(peak.way) / (peak.size * peak.size)});
  }
  return {};
}

tl::unexpected<Error> SurfacePreviewer::located(Error error, int frame) const {
  if (error.code == ErrorCode::Interrupted) return fail(std::move(error));
  error.message = fmt::format("surface \"{}\", frame {}: {}", surface_.name, frame, error.message);
  return fail(scene_.origin.located(std::move(error), scene_.origin.at(surface_.name)));
}

}  // namespace pliant
