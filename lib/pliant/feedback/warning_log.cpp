#include "pliant/feedback/warning_log.hpp"

#include <algorithm>
#include <set>
#include <string_view>

namespace pliant {

FrameRanges& WarningLog::frames_of(FramesOfCauses& causes, const CauseView& cause) {
  const auto found = causes.find(cause);
  if (found != causes.end()) return found->second;
  return causes[{cause.kind, std::string(cause.surface), std::string(cause.force),
                 std::string(cause.other)}];
}

void WarningLog::add(Warning::Kind kind, std::string_view surface, std::string_view force,
                     int frame, std::string_view other) {
  frames_of(frames_, {kind, surface, force, other}).add(frame);
}

void WarningLog::add_inside(Warning::Kind kind, std::string_view surface, std::string_view collider,
                            int frame, const NodesInside& inside) {
  if (inside.count == 0) return;
  add(kind, surface, collider, frame);
  NodesInside& worst = inside_[{kind, std::string(surface), std::string(collider)}];
  worst = {std::max(worst.count, inside.count), std::max(worst.depth, inside.depth)};
}

void WarningLog::expect(Warning::Kind kind, std::string_view surface, std::string_view force,
                        int frame) {
  frames_of(expected_, {kind, surface, force}).add(frame);
}

void WarningLog::happened(Warning::Kind kind, std::string_view surface, std::string_view force) {
  if (happened_.contains(CauseView{kind, surface, force})) return;
  happened_.insert({kind, std::string(surface), std::string(force)});
}

std::vector<Warning> WarningLog::warnings(const Scene& scene, bool is_range_complete) const {
  FramesOfCauses all = frames_;
  std::set<CauseView> never;  // expected, but it did not happen
  for (const auto& [cause, frames] : expected_) {
    if (happened_.contains(cause)) continue;
    all.emplace(cause, frames);
    never.insert(cause);
  }
  std::vector<Warning> warnings;
  for (const auto& [cause, frames] : all) {
    if (cause.kind == Warning::Kind::ForcesApart && !warnings.empty() &&
        warnings.back().kind == cause.kind && warnings.back().surface == cause.surface) {
      warnings.back().others.push_back(cause.force);
      warnings.back().frames.add(frames);
      continue;
    }
    Warning& warning = warnings.emplace_back();
    warning = {cause.kind, cause.surface, cause.force, frames};
    if (!cause.other.empty()) warning.others.push_back(cause.other);
    if (const auto inside = inside_.find(cause); inside != inside_.end())
      warning.inside = inside->second;
    warning.is_of_part = !is_range_complete && never.contains(cause);
  }
  // An author who writes combine="box" explicitly needs no warning.
  std::erase_if(warnings, [&](const Warning& warning) {
    return warning.kind == Warning::Kind::ForcesApart &&
           scene.origin.gives(warning.surface, "combine");
  });
  std::set<std::string_view> groups;
  for (const Group& group : scene.groups) groups.insert(group.name);
  for (Warning& warning : warnings) warning.is_group = groups.contains(warning.force);
  return warnings;
}

void add_facts(WarningLog& log, const Surface& of, int frame, const SurfaceInputs& inputs,
               const StepFacts& facts) {
  using enum Warning::Kind;
  const std::string_view surface = of.name;
  if (facts.has_loose_patch) log.add(LoosePatch, surface, {}, frame);
  // A whole body waits for no force: if it is not solved, nothing of it can move, and no force and
  // no tangent is to blame.
  if (of.solver.region == SolvedRegion::All && !facts.is_solved) {
    if (!facts.has_loose_patch) log.add(AllHeld, surface, {}, frame);
    return;
  }
  for (std::size_t k = 0; k < facts.forces.size(); ++k) {
    const ForceSource& source = inputs.sources[k];
    const std::string_view force = source.name;
    const ForceFacts& of_force = facts.forces[k];
    if (of_force.is_too_small) {
      log.add(facts.is_surface ? AllHeld : RegionTooSmall, surface, force, frame);
    }
    if (of_force.is_between_nodes) log.add(BetweenNodes, surface, force, frame);
    if (of_force.is_outside) log.add(OutsideRegion, surface, force, frame);
    if (of_force.is_lost) log.add(LostNodes, surface, force, frame);
    if (of_force.is_apart) log.add(ForcesApart, surface, force, frame);
    // A force with named targets is expected to affect each of them; a force without, at least one
    // surface.
    const std::string_view place = source.targets.empty() ? std::string_view() : surface;
    if (source.selects) {
      log.expect(SelectsNothing, place, force, frame);
      if (of_force.touches) log.happened(SelectsNothing, place, force);
    }
    if (of_force.is_push_awaited) {
      log.expect(PushesNothing, place, force, frame);
      if (of_force.pushes) log.happened(PushesNothing, place, force);
    }
  }
  if (!inputs.body.tangents.are_zero()) {
    log.expect(TangentsUnused, surface, {}, frame);
    if (facts.is_solved) log.happened(TangentsUnused, surface, {});
  }
}

void add_contacts(WarningLog& log, const Scene& scene, const Surface& surface, int frame,
                  const std::vector<ContactFacts>& contacts) {
  using enum Warning::Kind;
  const auto name_of = [&](int collider) -> std::string_view {
    return scene.colliders.at(static_cast<std::size_t>(collider)).name;
  };
  for (const ContactFacts& facts : contacts) {
    const std::string_view collider = name_of(facts.collider);
    log.add_inside(BeginsInside, surface.name, collider, frame, facts.thrown);
    log.add_inside(HeldInside, surface.name, collider, frame + 1, facts.held);
    for (const int other : facts.squeezed)
      log.add(Squeezed, surface.name, collider, frame + 1, name_of(other));
  }
}

}  // namespace pliant
