#include "pliant/exchange/scene_curves.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/exchange/curve_names.hpp"
#include "pliant/exchange/formats.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/scene/format/description.hpp"
#include "pliant/scene/format/nearest.hpp"
#include "pliant/timeline/edit/edit.hpp"

namespace pliant {
namespace {

using exchange::split_channel;

CurveUnit unit_of(const Attribute& attribute) {
  if (attribute.unit == "length") return CurveUnit::Length;
  return attribute.unit == "degrees" ? CurveUnit::Degrees : CurveUnit::Number;
}

// Visits every channel with its path, attribute and the order of its rotation.
template <class Visit>
void for_each_channel_of(const Scene& scene, const Visit& visit) {
  const auto thing = [&](const auto& each, RotateOrder order) {
    for_each_channel(each,
                     [&](const std::string& name, const Attribute& attribute, const auto& channel) {
                       visit(each.name + '.' + name, attribute, channel, order);
                     });
  };
  for (const Surface& surface : scene.surfaces) thing(surface, surface.transform.rotate_order);
  for (const Force& force : scene.forces) thing(force, RotateOrder::Xyz);
  for (const Group& group : scene.groups) thing(group, RotateOrder::Xyz);
  for (const Collider& collider : scene.colliders) thing(collider, collider.transform.rotate_order);
}

const Channel<1>& plain_channel(const Switch& channel) { return channel.channel(); }
template <int D>
const Channel<D>& plain_channel(const Channel<D>& channel) {
  return channel;
}

tl::unexpected<Error> unknown_channel(std::string_view option, const std::string& path,
                                      const Scene& scene) {
  return invalid(fmt::format("{}{}: {}", option, path, no_channel(scene, path)));
}

int component_of_word(std::string_view word) {
  if (word.size() != 1 || word[0] < 'x' || word[0] > 'z') return -1;
  return word[0] - 'x';
}

/// What a scene has, by its name. It must outlive this.
class SceneNames {
 public:
  explicit SceneNames(const Scene& scene) {
    for (NamedChannel& channel : channels_of(scene)) {
      std::string path = channel.path;
      channels_.try_emplace(std::move(path), std::move(channel));
    }
    for (const Surface& surface : scene.surfaces) things_.insert(surface.name);
    for (const Force& force : scene.forces) things_.insert(force.name);
    for (const Group& group : scene.groups) things_.insert(group.name);
    for (const Collider& collider : scene.colliders) things_.insert(collider.name);
  }

  /// Null: there is none.
  const NamedChannel* channel(const std::string& path) const {
    const auto found = channels_.find(path);
    return found == channels_.end() ? nullptr : &found->second;
  }
  bool has_thing(const std::string& name) const { return things_.contains(name); }

 private:
  std::unordered_map<std::string, NamedChannel> channels_;
  std::unordered_set<std::string> things_;
};

/// The curves of a file that go to one channel.
struct ChannelSources {
  std::string channel;
  std::string text;  // of its first mapping, for messages
  std::array<std::optional<CurveKeys<1>>, 3> components;
  std::optional<CurveKeys<1>> number;
};

class Placer {
 public:
  Placer(const CurveFile& file, const Scene* scene, double offset, double tolerance,
         const StopRequest& should_stop)
      : file_(file),
        curves_(file),
        scene_(scene),
        offset_(offset),
        tolerance_(tolerance),
        should_stop_(should_stop) {
    if (scene) names_.emplace(*scene);
  }

  Result<PlacedCurves> place(const std::vector<CurveMapping>& mappings) {
    for (const CurveMapping& mapping : mappings) {
      if (is_stopped(should_stop_)) return interrupted();
      if (auto added = add(mapping); !added) return fail(added.error());
    }
    for (ChannelSources& channel : channels_) {
      if (is_stopped(should_stop_)) return interrupted();
      if (auto placed = place(channel); !placed) return fail(placed.error());
    }
    return std::move(result_);
  }

 private:
  tl::unexpected<Error> broken(const std::string& mapping, const std::string& problem) const {
    return invalid(fmt::format("--map {}: {}", mapping, problem));
  }

  static std::string text_of_mapping(const CurveMapping& mapping) {
    return fmt::format("{}={}{}", mapping.source, mapping.channel,
                       exchange::component_suffix(mapping.component));
  }

  Result<void> add(const CurveMapping& mapping) {
    const std::string text = text_of_mapping(mapping);
    const std::vector<const FileCurve*> curves = curves_.find(mapping.source);
    if (curves.empty()) {
      std::vector<std::string_view> names;
      for (const FileCurve& curve : file_.curves)
        if (names.size() < 20) names.push_back(curve.name);
      return broken(text,
                    fmt::format("the file has no such curve{}", xml::hint(mapping.source, names)));
    }
    const bool is_group = curves.size() > 1 || curves[0]->name != mapping.source;
    if (is_group && mapping.component >= 0)
      return broken(text, "a component takes one curve, but this names several; add .x, .y or .z");
    ChannelSources& channel = channel_of(mapping.channel, text);
    for (const FileCurve* curve : curves) {
      auto keys = changed(*curve, mapping.factor);
      if (!keys && keys.error().code == ErrorCode::Interrupted) return fail(keys.error());
      if (!keys) return broken(text, keys.error().message);
      const int component = is_group ? curve->component : mapping.component;
      auto& place =
          component < 0 ? channel.number : channel.components[static_cast<std::size_t>(component)];
      if (place) return broken(text, "this was mapped before");
      place = *std::move(keys);
    }
    return {};
  }

  ChannelSources& channel_of(const std::string& path, const std::string& text) {
    const auto [number, is_new] = channel_numbers_.try_emplace(path, channels_.size());
    if (is_new) channels_.push_back({path, text, {}, {}});
    return channels_[number->second];
  }

  /// The keys later by the offset, and their values times the factor.
  Result<CurveKeys<1>> changed(const FileCurve& from, double factor) const {
    auto curve = Curve<1>::make(from.keys, should_stop_);
    if (!curve) return fail(exchange::error_of(curve.error(), ""));
    if (factor != 1) {
      if (factor == 0) return invalid("the factor is 0");
      auto scaled = scale(*curve, Scaling<1>{.value_factor = {factor}});
      if (!scaled) return invalid(scaled.error().message);
      curve = std::move(scaled);
    }
    if (offset_ != 0) {
      auto moved = move_keys(*curve, offset_, {0});
      if (!moved) return invalid(moved.error().message);
      curve = std::move(moved);
    }
    return curve->keys();
  }

  Result<void> place(ChannelSources& sources) {
    const std::string& path = sources.channel;
    const bool has_components =
        std::ranges::any_of(sources.components, [](const auto& each) { return each.has_value(); });
    if (sources.number && has_components)
      return broken(sources.text, "the channel is mapped as a whole and by a component");
    Value<3> constant{};
    std::optional<CurveKeys<3>> own;  // those of the scene, for components that are not mapped
    bool is_vector = has_components;
    PlacedCurve placed{path, {}, false};
    if (scene_) {
      const auto [thing, attribute] = split_channel(path);
      if (!names_->has_thing(thing) || attribute.empty())
        return unknown_channel(fmt::format("--map {}: ", sources.text), path, *scene_);
      if (const NamedChannel* const channel = names_->channel(path)) {
        if (const auto* vector = std::get_if<const Channel<3>*>(&channel->channel)) {
          constant = (*vector)->at(scene_->start);
          if ((*vector)->is_animated()) own = (*vector)->curve().keys();
          is_vector = true;
        } else if (is_vector && !is_tangent(attribute)) {
          return broken(sources.text, "this channel is a number, not a vector");
        }
        placed.is_switch = std::holds_alternative<const Switch*>(channel->channel);
      }
    } else {
      placed.is_switch = split_channel(path).second == "enabled";
    }
    if (is_vector && sources.number && !is_tangent(split_channel(path).second)) {
      return broken(sources.text,
                    "this channel is a vector; name one of its components, such as " + path + ".x");
    }
    if (sources.number) {
      if (placed.is_switch) {
        if (auto made = make_switch(*sources.number, sources); !made) return made;
      }
      placed.keys = *std::move(sources.number);
      result_.curves.push_back(std::move(placed));
      return {};
    }
    std::array<const CurveKeys<1>*, 3> components{};
    for (std::size_t c = 0; c < 3; ++c) {
      auto& component = sources.components[c];
      if (!component && own) component = component_of(*own, static_cast<int>(c));
      components[c] = component ? &*component : nullptr;
    }
    auto joined = join_curves(components, constant, tolerance_, should_stop_);
    if (!joined && joined.error().code == ErrorCode::Interrupted) return fail(joined.error());
    if (!joined) return broken(sources.text, joined.error().message);
    for (std::string& loss : joined->losses)
      result_.losses.push_back({path, std::move(loss), false});
    placed.keys = std::move(joined->keys);
    result_.curves.push_back(std::move(placed));
    return {};
  }

  /// Tangents of a grid are one number or three.
  static bool is_tangent(const std::string& attribute) {
    return attribute == "su0" || attribute == "su1" || attribute == "sv0" || attribute == "sv1";
  }

  Result<void> make_switch(CurveKeys<1>& keys, const ChannelSources& sources) {
    bool steps = true;
    for (Key<1>& key : keys.keys) {
      if (key.value[0] != 0 && key.value[0] != 1) {
        return broken(sources.text, fmt::format("a switch is 0 or 1, but key {} has the value {}",
                                                key.frame, key.value[0]));
      }
      const bool is_step = key.next.kind == Interpolation::Kind::Step ||
                           key.next.kind == Interpolation::Kind::StepNext;
      steps = steps && (is_step || &key == &keys.keys.back());
      key.in = key.out = {};
      key.left.reset();
      if (!is_step) key.next = {.kind = Interpolation::Kind::Step};
    }
    for (Extrapolation<1>* side : {&keys.before, &keys.after}) {
      const bool is_copies = side->kind == Extrapolation<1>::Kind::Repeat ||
                             side->kind == Extrapolation<1>::Kind::Mirror;
      if (!is_copies) *side = {};
    }
    keys.overshoot = Overshoot::Limit;
    if (!steps)
      result_.losses.push_back({sources.channel, "a switch steps: its segments became steps"});
    return {};
  }

  const CurveFile& file_;
  CurveIndex curves_;
  const Scene* scene_;
  std::optional<SceneNames> names_;
  double offset_;
  double tolerance_;
  const StopRequest& should_stop_;
  std::vector<ChannelSources> channels_;
  std::unordered_map<std::string, std::size_t> channel_numbers_;  // by their paths
  PlacedCurves result_;
};

}  // namespace

Result<std::vector<ChannelCurve>> curves_of(const Scene& scene,
                                            const std::vector<std::string>& paths) {
  std::vector<ChannelCurve> all;
  for_each_channel_of(scene, [&](const std::string& path, const Attribute& attribute,
                                 const auto& channel, RotateOrder order) {
    if (!channel.is_animated()) return;
    all.push_back({path, plain_channel(channel).curve(), unit_of(attribute), order});
  });
  if (paths.empty()) return all;
  std::vector<ChannelCurve> chosen;
  const SceneNames names(scene);
  for (const std::string& path : paths) {
    const auto found =
        std::ranges::find_if(all, [&](const ChannelCurve& curve) { return curve.channel == path; });
    if (found == all.end()) {
      if (names.channel(path))
        return invalid(fmt::format("--channel {}: is constant, so it has no keys", path));
      return unknown_channel("--channel ", path, scene);
    }
    const bool is_new = std::ranges::none_of(
        chosen, [&](const ChannelCurve& curve) { return curve.channel == path; });
    if (is_new) chosen.push_back(*found);
  }
  return chosen;
}

Result<CurveMapping> parse_mapping(std::string_view text) {
  const auto broken = [&](std::string_view rule) {
    return invalid(fmt::format("--map {}: {}", text, rule));
  };
  constexpr std::string_view form = "must be SOURCE=CHANNEL[.x|.y|.z][*FACTOR]";
  const std::size_t equals = text.rfind('=');
  if (equals == std::string_view::npos || equals == 0) return broken(form);
  CurveMapping mapping{.source = std::string(text.substr(0, equals)), .channel = {}};
  std::string_view target = text.substr(equals + 1);
  if (const std::size_t star = target.find('*'); star != std::string_view::npos) {
    const auto factor = to_number(target.substr(star + 1));
    if (!factor || *factor == 0) return broken("the factor must be a finite number other than 0");
    mapping.factor = *factor;
    target = target.substr(0, star);
  }
  const std::size_t dot = target.find('.');
  if (dot == std::string_view::npos || dot == 0 || dot + 1 == target.size()) return broken(form);
  const std::size_t last = target.rfind('.');
  if (last != dot) mapping.component = component_of_word(target.substr(last + 1));
  if (mapping.component >= 0) target = target.substr(0, last);
  mapping.channel = std::string(target);
  return mapping;
}

std::vector<CurveMapping> mappings_by_name(const CurveFile& file, const Scene& scene) {
  struct Target {
    const NamedChannel* channel;
    bool is_own_node;
  };
  const std::vector<NamedChannel> channels = channels_of(scene);
  std::unordered_map<std::string, std::vector<Target>> targets;  // by the name of a group
  for (const NamedChannel& channel : channels) {
    const auto [thing, attribute] = split_channel(channel.path);
    const std::string_view path = exchange::path_of_attribute(attribute);
    // A glTF has `poke.translation`, or `poke.magnitude.translation` for a number along x.
    targets[channel.path].push_back({&channel, false});
    targets[path.empty() ? channel.path + ".translation" : thing + '.' + std::string(path)]
        .push_back({&channel, path.empty()});
  }
  std::vector<CurveMapping> mappings;
  for (const FileCurve& curve : file.curves) {
    const auto found = targets.find(curve.group);
    if (found == targets.end()) continue;
    for (const auto& [channel, is_own_node] : found->second) {
      const bool is_vector = std::holds_alternative<const Channel<3>*>(channel->channel);
      if (is_vector && curve.component < 0) continue;
      const bool is_number = !is_vector;
      if (is_number && curve.component > 0) continue;
      if (is_number && curve.component == 0 && !is_own_node) continue;
      mappings.push_back({curve.name, channel->path, is_vector ? curve.component : -1, 1});
      break;
    }
  }
  return mappings;
}

CurveIndex::CurveIndex(const CurveFile& file) {
  for (const FileCurve& curve : file.curves) {
    by_name_[curve.name].push_back(&curve);
    if (curve.component >= 0) by_group_[curve.group].push_back(&curve);
  }
}

std::vector<const FileCurve*> CurveIndex::find(const std::string& source) const {
  for (const auto* const index : {&by_name_, &by_group_})
    if (const auto found = index->find(source); found != index->end()) return found->second;
  return {};
}

bool is_of_vector(const CurveMapping& mapping, const CurveIndex& curves) {
  const std::vector<const FileCurve*> found = curves.find(mapping.source);
  if (found.empty()) return false;
  const bool is_one = found.front()->name == mapping.source;
  return mapping.component >= 0 ? is_one && found.front()->component == mapping.component : !is_one;
}

std::vector<CurveMapping> with_z_up(const std::vector<CurveMapping>& mappings,
                                    const CurveFile& file) {
  const CurveIndex curves(file);
  std::vector<CurveMapping> turned;
  for (const CurveMapping& mapping : mappings) {
    if (!is_of_vector(mapping, curves)) {
      turned.push_back(mapping);
      continue;
    }
    const bool is_scale = split_channel(mapping.channel).second == "scale";
    for (const FileCurve* const curve : curves.find(mapping.source)) {
      constexpr int places[] = {0, 2, 1};  // of x, y and z
      const double sign = curve->component == 1 && !is_scale ? -1 : 1;
      turned.push_back(
          {curve->name, mapping.channel, places[curve->component], sign * mapping.factor});
    }
  }
  return turned;
}

Result<PlacedCurves> place_curves(const CurveFile& file, const std::vector<CurveMapping>& mappings,
                                  const Scene* scene, double offset, double tolerance,
                                  const StopRequest& should_stop) {
  return Placer(file, scene, offset, tolerance, should_stop).place(mappings);
}

}  // namespace pliant
