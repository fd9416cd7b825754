#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "pliant/feedback/contact_summary.hpp"
#include "pliant/feedback/scene_look.hpp"
#include "pliant/feedback/warnings.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/sampling/animated_shape.hpp"
#include "pliant/sampling/material_maps.hpp"
#include "pliant/sampling/sampling.hpp"
#include "pliant/sampling/targets.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/scene/format/surface_description.hpp"

namespace pliant {
namespace {

using Kind = Warning::Kind;

// The frames of the span for which `holds(frame)`.
template <class Holds>
FrameRanges frames_where(const FrameSpan& span, const Holds& holds) {
  FrameRanges frames;
  for (int frame = span.first; frame <= span.last; ++frame)
    if (holds(frame)) frames.add(frame);
  return frames;
}

// The places of a force that has some.
std::vector<const PositionChannel*> places_of(const Force& force) {
  return std::visit(
      []<class Of>(const Of& kind) -> std::vector<const PositionChannel*> {
        if constexpr (requires { kind.from; })
          return {&kind.from, &kind.to};
        else if constexpr (requires { kind.center; })
          return {&kind.center};
        else
          return {};
      },
      force.kind);
}

// The warnings that need the scene only, and what of it is looked up once.
class SceneWarnings {
 public:
  explicit SceneWarnings(const Scene& scene)
      : scene_(scene),
        played_(sampled_frames(scene)),
        solved_(solved_frames(played_)),
        all_solved_(ranges_of(solved_)),
        surfaces_of_force_(scene.forces.size()),
        surfaces_of_group_(scene.groups.size()),
        surfaces_of_collider_(scene.colliders.size()) {
    for (std::size_t k = 0; k < scene.groups.size(); ++k) groups_[scene.groups[k].name] = k;
    const std::vector<SurfaceTargets> targets = targets_of(scene);
    for (std::size_t k = 0; k < scene.surfaces.size(); ++k) {
      if (!is_solved(scene.surfaces[k])) continue;
      for (const SurfaceTargets::Member& member : targets[k].forces)
        surfaces_of_force_[member.force].push_back(&scene.surfaces[k]);
      for (const std::size_t group : targets[k].groups)
        surfaces_of_group_[group].push_back(&scene.surfaces[k]);
      for (const std::size_t collider : targets[k].colliders)
        surfaces_of_collider_[collider].push_back(&scene.surfaces[k]);
    }
  }

  std::vector<Warning> find() {
    add_keys_outside();
    for (std::size_t k = 0; k < scene_.forces.size(); ++k) {
      const Force& force = scene_.forces[k];
      const Group* const group = group_of(force);
      if (!is_on(force.enabled) || (group && !is_on(group->enabled))) continue;
      if (surfaces_of_force_[k].empty()) continue;
      add_inertia(force, group, surfaces_of_force_[k]);
      if (!group && !places_of(force).empty()) add_radii(force, surfaces_of_force_[k]);
    }
    for (std::size_t k = 0; k < scene_.groups.size(); ++k) {
      if (is_on(scene_.groups[k].enabled))
        add_unused_radius(scene_.groups[k], surfaces_of_group_[k]);
    }
    for (std::size_t k = 0; k < scene_.colliders.size(); ++k) {
      if (is_on(scene_.colliders[k].enabled))
        add_unused_radius(scene_.colliders[k], surfaces_of_collider_[k]);
    }
    return std::move(warnings_);
  }

  const Group* group_of(const Force& force) const {
    const auto found = groups_.find(force.group);
    return found == groups_.end() ? nullptr : &scene_.groups[found->second];
  }

 private:
  Warning& add(Kind kind, const std::string& force) {
    Warning& warning = warnings_.emplace_back();
    warning.kind = kind;
    warning.force = force;
    warning.is_group = groups_.contains(force);
    return warning;
  }

  void add_keys_outside() {
    std::map<std::string_view, FrameSpan> played;  // of what is on, by its name
    for (const Surface& surface : scene_.surfaces)
      played.emplace(surface.name, sampled_frames(scene_, surface));
    for (const Force& force : scene_.forces) {
      const Group* const group = group_of(force);
      if (is_on(force.enabled) && (!group || is_on(group->enabled)))
        played.emplace(force.name, played_);
    }
    for (const Group& group : scene_.groups)
      if (is_on(group.enabled)) played.emplace(group.name, played_);
    for (const Collider& collider : scene_.colliders)
      if (is_on(collider.enabled)) played.emplace(collider.name, played_);
    for (const NamedChannel& channel : channels_of(scene_)) {
      const auto keys = keys_of(channel);
      const auto found =
          played.find(std::string_view(channel.path).substr(0, channel.path.find('.')));
      if (!keys || found == played.end() || !keys->is_outside(found->second)) continue;
      const bool is_late = keys->first > found->second.last;
      Warning& warning = warnings_.emplace_back();
      warning.kind = Kind::KeysOutside;
      warning.channel = channel.path;
      warning.told = fmt::format(
          "outside the frames {} to {} that are played: all are {} them, {}, so that it keeps the "
          "value of the {} one; move the keys, or change start and end",
          found->second.first, found->second.last, is_late ? "after" : "before", keys->text(),
          is_late ? "first" : "last");
    }
  }

  // One that names its targets is meant to act on each of them; another, on some surface.
  void add_inertia(const Force& force, const Group* group,
                   const std::vector<const Surface*>& surfaces) {
    if (!is_inertia(force)) return;
    std::vector<const Surface*> still;
    for (const Surface* surface : surfaces)
      if (stands_still(*surface, sampled_frames(scene_, *surface))) still.push_back(surface);
    const bool is_named = !force.targets.empty() || (group && !group->targets.empty());
    if (still.empty() || (!is_named && still.size() < surfaces.size())) return;
    Warning& warning = add(Kind::NeverMoves, force.name);
    warning.frames = ranges_of(played_);
    warning.told = names_text(still);
  }

  void add_radii(const Force& force, const std::vector<const Surface*>& surfaces) {
    add_unused_radius(force, surfaces);
    if (!std::ranges::all_of(surfaces, [](const Surface* surface) {
          return surface->solver.region == SolvedRegion::Forces;
        })) {
      return;
    }
    const auto exceeds = [&](int frame) {
      // With a radius of 0 it pushes in the regions of other forces.
      const double deformation = force.deformation_radius.at(frame)[0];
      return force.enabled.at(frame) && deformation > 0 && force.magnitude.at(frame)[0] != 0 &&
             force.force_radius.at(frame)[0] > deformation;
    };
    const bool is_same_always = !force.enabled.is_animated() && !force.magnitude.is_animated() &&
                                !force.deformation_radius.is_animated() &&
                                !force.force_radius.is_animated();
    if (is_same_always && !exceeds(solved_.first)) return;
    FrameRanges frames = is_same_always ? all_solved_ : frames_where(solved_, exceeds);
    if (!frames.ranges().empty()) add(Kind::RadiusExceeds, force.name).frames = std::move(frames);
  }

  template <class Acting>
  void add_unused_radius(const Acting& acting, const std::vector<const Surface*>& surfaces) {
    // One in an included file may select in other scenes.
    if (!scene_.origin.gives(acting.name, "deformationRadius") ||
        !scene_.origin.is_own(acting.name, "deformationRadius") || surfaces.empty()) {
      return;
    }
    if (!std::ranges::all_of(surfaces, [](const Surface* surface) {
          return surface->solver.region == SolvedRegion::All;
        })) {
      return;
    }
    add(Kind::RadiusUnused, acting.name).told = names_text(surfaces);
  }

  const Scene& scene_;
  FrameSpan played_, solved_;
  FrameRanges all_solved_;
  std::map<std::string_view, std::size_t> groups_;
  std::vector<std::vector<const Surface*>> surfaces_of_force_, surfaces_of_group_,
      surfaces_of_collider_;
  std::vector<Warning> warnings_;
};

// Whether some node at rest moves by more than a limit from one frame to another.
bool moves_beyond(const Field& from, const Transform& first, const Field& to, const Transform& now,
                  double limit) {
  const double most = limit * limit;
  for (Eigen::Index k = 0; k < from.rows(); ++k) {
    const Vector3d p = from.row(k), q = to.row(k);
    const Vector3d way = to_world(now, q) - to_world(first, p);
    if (way.squaredNorm() > most) return true;
  }
  return false;
}

// A force or group that stays in its place, on a surface that moves.
struct Staying {
  const std::string& name;
  bool is_group;
  std::string_view radius_name;
  std::function<bool(int frame)> acts;
  const Channel<1>& radius;
  FrameRanges frames = {};  // at which it acts, and the surface has moved away
};

std::vector<Staying> all_staying(const Scene& scene, const Surface& surface,
                                 const SurfaceTargets& targets) {
  std::vector<Staying> all;
  const bool is_whole = surface.solver.region == SolvedRegion::All;
  for (const SurfaceTargets::Member& member : targets.forces) {
    const Force& force = scene.forces[member.force];
    const Group* const group = targets.group_of(member, scene);
    const auto places = places_of(force);
    if (places.empty() || !force.follow.empty() ||
        std::ranges::any_of(places, [](const auto* place) { return place->is_animated(); })) {
      continue;
    }
    const bool by_push = group || is_whole;
    all.push_back({.name = force.name,
                   .is_group = false,
                   .radius_name = by_push ? "forceRadius" : "deformationRadius",
                   .acts =
                       [&force, group](int frame) {
                         return is_enabled(force, group, frame) &&
                                force.magnitude.at(frame)[0] != 0;
                       },
                   .radius = by_push ? force.force_radius : force.deformation_radius});
  }
  if (is_whole) return all;  // then groups select nothing
  for (const std::size_t k : targets.groups) {
    const Group& group = scene.groups[k];
    if (!group.follow.empty() || group.center.is_animated()) continue;
    all.push_back({.name = group.name,
                   .is_group = true,
                   .radius_name = "deformationRadius",
                   .acts = [&group](int frame) { return group.enabled.at(frame); },
                   .radius = group.deformation_radius});
  }
  return all;
}

// At most `most` frames, the first and the last one among them.
std::vector<int> spread(const FrameSpan& span, int most) {
  const std::int64_t steps = span.count() - 1;
  const std::int64_t count = std::min<std::int64_t>(span.count(), most);
  std::vector<int> frames;
  for (std::int64_t k = 0; k < count; ++k)
    frames.push_back(span.first + static_cast<int>(count > 1 ? k * steps / (count - 1) : 0));
  return frames;
}

// The corners of the box around points, 8 x 3.
Field corners_of(const Field& points) {
  Field corners(8, 3);
  for (int corner = 0; corner < 8; ++corner) {
    for (int k = 0; k < 3; ++k)
      corners(corner, k) =
          (corner >> k) % 2 == 0 ? points.col(k).minCoeff() : points.col(k).maxCoeff();
  }
  return corners;
}

void add_drifts(std::vector<Warning>& warnings, const Scene& scene, const Surface& surface,
                const RestShape& shape, const SurfaceTargets& targets) {
  const FrameSpan played = sampled_frames(scene, surface);
  if (!is_solved(surface) || shape.rest.rows() == 0 || stands_still(surface, played)) return;
  std::vector<Staying> all = all_staying(scene, surface, targets);
  if (all.empty()) return;
  const bool is_animated = shape.animation != nullptr;
  const Field corners = corners_of(shape.rest);
  const std::shared_ptr<const Field> still(std::shared_ptr<const Field>(), &shape.rest);
  const Transform first = surface.transform.at(played.first);
  std::shared_ptr<const Field> from;  // the surface in the first frame
  for (const int frame : spread(played, is_animated ? most_cache_frames : most_moved_frames)) {
    const Transform now = surface.transform.at(frame);
    std::shared_ptr<const Field> to = still;
    if (is_animated) {
      const auto nodes = shape.animation->nodes_at(frame);
      if (!nodes) return;  // the run tells of it
      to = *nodes;
    }
    if (!from) from = to;
    for (Staying& one : all) {
      if (!one.acts(frame)) continue;
      const double limit = one.radius.at(frame)[0];
      // The box around all nodes moves at least as far, and mostly not far enough.
      if (!is_animated && !moves_beyond(corners, first, corners, now, limit)) continue;
      if (moves_beyond(*from, first, *to, now, limit)) one.frames.add(frame);
    }
  }
  for (Staying& one : all) {
    if (one.frames.ranges().empty()) continue;
    Warning& warning = warnings.emplace_back();
    warning.kind = Kind::Drifts;
    warning.surface = surface.name;
    warning.force = one.name;
    warning.is_group = one.is_group;
    warning.frames = std::move(one.frames);
    warning.told = one.radius_name;
  }
}

void add_map(std::vector<Warning>& warnings, const Surface& surface, const MaterialMap& map,
             const MapSummary& summary) {
  std::string told = outside_unit_range(map, summary);
  if (told.empty()) return;
  Warning& warning = warnings.emplace_back();
  warning.kind = Kind::MapOutside;
  warning.surface = surface.name;
  warning.channel = fmt::format("{}.map.{}", surface.name,
                                map_channel_words[static_cast<std::size_t>(map.channel)]);
  warning.told = std::move(told);
}

// Colliders that fit between the nodes of a surface.
void add_gaps(std::vector<Warning>& warnings, const Scene& scene, const Surface& surface,
              const RestShape& shape, const SurfaceTargets& targets) {
  if (!is_solved(surface) || targets.colliders.empty()) return;
  const double spacing = spacing_of(scene, surface, shape).mean;
  for (const std::size_t k : targets.colliders) {
    const Collider& collider = scene.colliders[k];
    const ColliderMesh* const mesh =
        shape.collider_meshes ? (*shape.collider_meshes)[k].get() : nullptr;
    const std::optional<Solid> solid = solid_at(collider, scene.start, mesh);
    if (!is_on(collider.enabled) || !solid) continue;
    const double radius = inner_radius(*solid);
    if (!(spacing > radius)) continue;
    Warning& warning = warnings.emplace_back();
    warning.kind = Kind::PassesBetween;
    warning.surface = surface.name;
    warning.force = collider.name;
    warning.told = fmt::format("they are {:.3g} apart, and its least radius is {}{:.3g}", spacing,
                               mesh ? "at most " : "", radius);
  }
}

void add_cache(std::vector<Warning>& warnings, const Scene& scene, const RestShape& shape,
               const Surface& surface) {
  const auto cache = cache_summary_of(shape);
  const FrameSpan played = sampled_frames(scene, surface);
  if (!cache || (cache->last >= played.first && cache->first <= played.last)) return;
  Warning& warning = warnings.emplace_back();
  warning.kind = Kind::CacheOutside;
  warning.surface = shape.name;
  warning.cache = cache;
  warning.is_cache_late = cache->first > played.last;
}

}  // namespace

std::vector<Warning> warnings_about(const Scene& scene) { return SceneWarnings(scene).find(); }

std::vector<Warning> warnings_about(std::span<const RestShape> rest_shapes, const Scene& scene) {
  std::vector<Warning> warnings;
  const std::vector<SurfaceTargets> targets = targets_of(scene);
  for (std::size_t k = 0; k < rest_shapes.size(); ++k) {
    const RestShape& shape = rest_shapes[k];
    const Surface& surface = scene.surfaces[k];
    if (!shape.mesh.left_out.empty()) {
      Warning& warning = warnings.emplace_back();
      warning.kind = Kind::FileLeftOut;
      warning.surface = shape.name;
      warning.left_out = shape.mesh.left_out;
    }
    if (shape.surface && shape.surface->faces_left_out > 0) {
      Warning& warning = warnings.emplace_back();
      warning.kind = Kind::FacesLeftOut;
      warning.surface = shape.name;
      warning.faces = shape.surface->faces_left_out;
    }
    add_cache(warnings, scene, shape, surface);
    for (const MapSummary& summary : map_summaries_of(shape)) {
      const auto map = std::ranges::find(surface.maps, summary.channel, &MaterialMap::channel);
      if (map != surface.maps.end()) add_map(warnings, surface, *map, summary);
    }
    add_drifts(warnings, scene, surface, shape, targets[k]);
    add_gaps(warnings, scene, surface, shape, targets[k]);
  }
  for (Warning& warning : warnings_about(scene)) warnings.push_back(std::move(warning));
  return warnings;
}

void drop_repeated(std::vector<Warning>& warnings) {
  std::set<std::string> told;
  for (const Warning& warning : warnings)
    if (warning.kind == Kind::NeverMoves) told.insert(warning.force);
  std::erase_if(warnings, [&](const Warning& warning) {
    return warning.kind == Kind::PushesNothing && told.contains(warning.force);
  });
}

}  // namespace pliant
