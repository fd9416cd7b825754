#include "pliant/scene/write.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/scene/changes/change.hpp"
#include "pliant/scene/checks/channel_check.hpp"
#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/format/slot.hpp"
#include "pliant/scene/reading/curve_text.hpp"
#include "pliant/scene/reading/key_text.hpp"
#include "pliant/scene/reading/path.hpp"
#include "pliant/scene/reading/read_elements.hpp"
#include "pliant/scene/text/element_text.hpp"
#include "pliant/scene/text/findings.hpp"
#include "pliant/scene/text/markup.hpp"

namespace pliant {

using namespace xml;

namespace {

// Of the work for each, see StopPoll.
constexpr std::size_t parts_of_element = 4096, parts_of_point = 128;

template <int D>
std::int64_t copied_keys_of(const CurveKeys<D>& keys) {
  if (!keys.loop) return 0;
  const Loop<D>& loop = *keys.loop;
  const auto repeated = std::ranges::count_if(
      keys.keys, [&](const Key<D>& key) { return key.frame >= loop.from && key.frame < loop.to; });
  return repeated * (std::int64_t{loop.before} + loop.after);
}

class SceneWriter {
 public:
  SceneWriter(std::filesystem::path folder, const StopRequest& should_stop)
      : folder_(std::move(folder)), should_stop_(should_stop), poll_(should_stop) {}

  void write(const Scene& scene);

  std::int64_t copied_keys() const { return copied_keys_; }
  std::string text() const { return text_of(top_.children.front(), {}, {}, should_stop_) + '\n'; }

 private:
  void write(const Surface& surface);
  void write_shape(const Surface& surface);
  void write_material(const Surface& surface);
  std::string from_folder(const std::string& path) const;
  void write(const NurbsNet& net);
  void write(const Force& force);
  void write(const Group& group, const std::vector<const Force*>& forces);

  template <class Part>
  void write_part(const Part& part);
  // An <animate> or <path> for each channel of the thing that has one.
  template <class Thing>
  void write_channels(const Thing& thing);
  void write_channel(const Attribute& attribute, const Channel<1>& channel);
  void write_channel(const Attribute& attribute, const Channel<3>& channel);
  void write_channel(const Attribute& attribute, const Switch& channel);
  template <int D>
  void write_channel(const Attribute& attribute, const std::optional<Channel<D>>& channel);
  void write_channel(const Attribute& attribute, const TangentChannel& tangent);
  void write_channel(const Attribute& attribute, const PositionChannel& position);
  template <class Other>
  void write_channel(const Attribute&, const Other&) {}  // not a channel

  void write_path(std::string_view attribute, const PathMotion& motion);
  void write_attributes(const Table& table, const Table& standard) {
    add_attributes(*current_, table, standard);
  }

  void give(std::string_view name, std::string_view value) {
    current_->attributes.emplace_back(name, value);
  }

  template <class Write>
  void element(std::string_view name, const Write& write_content) {
    ElementText* const parent = std::exchange(current_, &current_->children.emplace_back());
    current_->name = name;
    write_content();
    current_ = parent;
  }
  template <int D>
  void write_curve(std::string_view attribute, const Curve<D>& curve, ValueKind kind) {
    current_->children.push_back(curve_element(attribute, curve.keys(), kind, should_stop_));
    copied_keys_ += copied_keys_of(curve.keys());
  }

  ElementText top_ = {};          // contains the root
  ElementText* current_ = &top_;  // that is being written
  std::filesystem::path folder_;
  const StopRequest& should_stop_;
  StopPoll poll_;
  std::int64_t copied_keys_ = 0;
};

void SceneWriter::write_path(std::string_view attribute, const PathMotion& motion) {
  PathText text{motion.progress, motion.path.is_closed()};
  PathText standard;
  element("path", [&] {
    give("attribute", attribute);
    write_attributes(table_of(text), table_of(standard));
    for (const Value<3>& place : motion.path.waypoints()) {
      if (poll_.after(parts_of_element)) return;
      Waypoint waypoint{place};
      const Table table = table_of(waypoint);
      element("waypoint", [&] { write_attributes(table, table); });
    }
    write_channels(text);
  });
}

template <class Thing>
void SceneWriter::write_channels(const Thing& thing) {
  const auto row = [&](const Attribute& attribute, const auto&... member) {
    (write_channel(attribute, member), ...);
  };
  describe(row, thing);
}

void SceneWriter::write_channel(const Attribute& attribute, const Channel<1>& channel) {
  if (channel.is_animated()) write_curve(attribute.name, channel.curve(), ValueKind::Number);
}

void SceneWriter::write_channel(const Attribute& attribute, const Channel<3>& channel) {
  if (channel.is_animated()) write_curve(attribute.name, channel.curve(), ValueKind::Vector);
}

void SceneWriter::write_channel(const Attribute& attribute, const Switch& channel) {
  if (channel.is_animated())
    write_curve(attribute.name, channel.channel().curve(), ValueKind::Boolean);
}

template <int D>
void SceneWriter::write_channel(const Attribute& attribute,
                                const std::optional<Channel<D>>& channel) {
  if (channel) write_channel(attribute, *channel);
}

void SceneWriter::write_channel(const Attribute& attribute, const TangentChannel& tangent) {
  std::visit([&](const auto& channel) { write_channel(attribute, channel); }, tangent);
}

void SceneWriter::write_channel(const Attribute& attribute, const PositionChannel& position) {
  if (position.path()) {
    write_path(attribute.name, *position.path());
  } else {
    write_channel(attribute, *position.channel());
  }
}

/// A part of a surface, unless everything in it is the default.
template <class Part>
void SceneWriter::write_part(const Part& part) {
  Part own = part;
  Part standard;
  const Table table = table_of(own);
  const Table defaults = table_of(standard);
  const bool is_default = std::equal(table.begin(), table.end(), defaults.begin(),
                                     [](const Slot& a, const Slot& b) { return a.text == b.text; });
  // One that is animated has no text, as one that is absent.
  bool is_animated = false;
  for_each_channel(part, [&](const std::string&, const Attribute&, const auto& channel) {
    is_animated = is_animated || channel.is_animated();
  });
  if (is_default && !is_animated) return;
  element(Description<Part>::element, [&] {
    write_attributes(table, defaults);
    write_channels(part);
  });
}

void SceneWriter::write_shape(const Surface& surface) {
  CacheFile cache = surface.cache;
  CacheFile no_cache;
  if (!cache.path.empty()) cache.path = from_folder(cache.path);
  if (auto sheet = std::get_if<GridSheet>(&surface.shape)) {
    GridSheet own = *sheet;
    GridSheet standard;
    element("grid", [&] { write_attributes(table_of(own, cache), table_of(standard, no_cache)); });
  } else if (auto net = std::get_if<NurbsNet>(&surface.shape)) {
    write(*net);
  } else if (auto mesh = std::get_if<MeshFile>(&surface.shape)) {
    MeshFile own = *mesh;
    MeshReading reading = surface.reading;
    MeshFile standard;
    MeshReading standard_reading;
    own.path = from_folder(own.path);
    if (!surface.subdivision) {
      element("mesh", [&] {
        write_attributes(table_of(own, reading, cache),
                         table_of(standard, standard_reading, no_cache));
      });
      return;
    }
    Subdivision subdivision = *surface.subdivision;
    Subdivision standard_subdivision;
    element("subdivision", [&] {
      write_attributes(table_of(own, reading, cache, subdivision),
                       table_of(standard, standard_reading, no_cache, standard_subdivision));
    });
  }
}

// A file's path as the scene names it.
std::string SceneWriter::from_folder(const std::string& path) const {
  return folder_.empty() ? path : path_from(folder_, path);
}

void SceneWriter::write_material(const Surface& surface) {
  if (surface.maps.empty()) return write_part(surface.material);
  MaterialChannels own = surface.material;
  MaterialChannels standard;
  element(Description<MaterialChannels>::element, [&] {
    write_attributes(table_of(own), table_of(standard));
    write_channels(own);
    for (MaterialMap map : surface.maps) {
      MaterialMap no_map;
      if (!map.file.empty()) map.file = from_folder(map.file);
      element(Description<MaterialMap>::element,
              [&] { write_attributes(table_of(map), table_of(no_map)); });
    }
  });
}

void SceneWriter::write(const NurbsNet& net) {
  NurbsNet own;  // without its numbers, which are no attributes
  own.u = {.count = net.u.count,
           .degree = net.u.degree,
           .is_closed = net.u.is_closed,
           .samples = net.u.samples};
  own.v = {.count = net.v.count,
           .degree = net.v.degree,
           .is_closed = net.v.is_closed,
           .samples = net.v.samples};
  NurbsNet standard;
  element("nurbs", [&] {
    write_attributes(table_of(own), table_of(standard));
    std::string points;
    for (Eigen::Index k = 0; k < net.points.rows() && !poll_.after(parts_of_point); ++k)
      points += fmt::format("{}{} {} {}", k == 0 ? "" : "\n", net.points(k, 0), net.points(k, 1),
                            net.points(k, 2));
    element("points", [&] { current_->text = points; });
    const auto write_numbers = [&](const std::vector<double>& numbers) {
      current_->text = fmt::format("{}", fmt::join(numbers, " "));
    };
    if (!net.weights.empty()) element("weights", [&] { write_numbers(net.weights); });
    for (const bool is_u : {true, false}) {
      const std::vector<double>& knots = (is_u ? net.u : net.v).knots;
      if (knots.empty()) continue;
      element("knots", [&] {
        give("along", is_u ? "u" : "v");
        write_numbers(knots);
      });
    }
  });
}

void SceneWriter::write(const Surface& surface) {
  if (poll_.after(parts_of_element)) return;
  Surface own;
  own.name = surface.name;
  own.enabled = surface.enabled;
  own.driven_by = surface.driven_by;
  Surface standard;
  element("surface", [&] {
    write_attributes(table_of(own), table_of(standard));
    write_shape(surface);
    write_part(surface.transform);
    if (surface.is_driven()) return;
    write_material(surface);
    write_part(surface.tangents);
    write_part(surface.solver);
  });
}

void SceneWriter::write(const Force& force) {
  if (poll_.after(parts_of_element)) return;
  Force own = force;
  Force standard = standard_force(force);
  if (!force.group.empty()) own.deformation_radius = standard.deformation_radius;
  element(kind_of(force), [&] {
    write_attributes(table_of(own), table_of(standard));
    write_channels(own);
    std::visit([&](const auto& kind) { write_channels(kind); }, own.kind);
    if (force.falloff_curve) write_curve("", *force.falloff_curve, ValueKind::Number);
  });
}

void SceneWriter::write(const Group& group, const std::vector<const Force*>& forces) {
  if (poll_.after(parts_of_element)) return;
  Group own = group;
  Group standard;
  element("group", [&] {
    write_attributes(table_of(own), table_of(standard));
    write_channels(group);
    for (const Force* const force : forces) write(*force);
  });
}

void SceneWriter::write(const Scene& scene) {
  Scene own;
  own.fps = scene.fps;
  own.start = scene.start;
  own.end = scene.end;
  own.seed = scene.seed;
  Scene standard;
  element("scene", [&] {
    give("version", "1");
    write_attributes(table_of(own), table_of(standard));
    for (const Surface& surface : scene.surfaces) write(surface);
    auto group = scene.groups.begin();
    for (auto force = scene.forces.begin(); force != scene.forces.end();) {
      if (force->group.empty()) {
        write(*force++);
        continue;
      }
      for (; group->name != force->group; ++group) write(*group, {});
      std::vector<const Force*> members;
      for (; force != scene.forces.end() && force->group == group->name; ++force)
        members.push_back(&*force);
      write(*group++, members);
    }
    for (; group != scene.groups.end(); ++group) write(*group, {});
  });
}

/// A <falloff> has keys from 0 to 1, and their end values outside them.
bool is_plain_falloff(const CurveKeys<1>& keys) {
  return keys.keys.front().frame >= 0 && keys.keys.back().frame <= 1 && !keys.loop &&
         keys.before == Extrapolation<1>{} && keys.after == Extrapolation<1>{};
}

std::optional<std::string> what_no_file_contains(const Scene& scene) {
  if (const auto channel = first_adjusted_channel(scene))
    return fmt::format("the curve of {} is adjusted, which a scene file cannot contain", *channel);
  for (const Surface& surface : scene.surfaces)
    if (std::holds_alternative<Mesh>(surface.shape))
      return fmt::format(
          "surface \"{}\" has a mesh made by a program, which a scene file cannot "
          "contain; write it to a mesh file",
          surface.name);
  for (const Surface& surface : scene.surfaces) {
    for (const MaterialMap& map : surface.maps) {
      if (!map.values.empty())
        return fmt::format(
            "{}.{} has values of a program, which a scene file cannot contain; write them to a "
            "file",
            surface.name, name_of(map.channel));
    }
  }
  for (const Force& force : scene.forces) {
    if (std::holds_alternative<CustomForce>(force.kind))
      return fmt::format("force \"{}\" is custom, which a scene file cannot contain", force.name);
    if (force.falloff_curve && !is_plain_falloff(force.falloff_curve->keys()))
      return fmt::format(
          "the falloff curve of \"{}\" has keys outside 0 to 1, a loop or an "
          "extrapolation, which a scene file cannot contain",
          force.name);
  }
  auto group = scene.groups.begin();
  const std::string* last = nullptr;  // the group of the force before
  for (const Force& force : scene.forces) {
    const bool is_next = last == nullptr || *last != force.group;
    last = force.group.empty() ? nullptr : &force.group;
    if (last == nullptr || !is_next) continue;
    group = std::find_if(group, scene.groups.end(),
                         [&](const Group& each) { return each.name == force.group; });
    if (group == scene.groups.end())
      return fmt::format(
          "force \"{}\" is apart from the other forces of the group \"{}\", or "
          "before those of an earlier group; in a scene file they are one after "
          "the other",
          force.name, force.group);
    ++group;
  }
  return {};
}

}  // namespace

Result<std::string> to_xml(const Scene& scene, const std::string& folder,
                           const StopRequest& should_stop) {
  std::vector<Error> errors = check_scene(scene, should_stop);
  StopPoll poll(should_stop);
  constexpr std::size_t parts_of_channel = 256;
  if (errors.empty())
    errors = check_channels(scene, {}, [&] { return poll.after(parts_of_channel); });
  if (is_stopped(should_stop)) return interrupted();
  if (!errors.empty()) return fail(std::move(errors.front()));
  if (auto problem = what_no_file_contains(scene))
    return fail(ErrorCode::InvalidInput, *std::move(problem));
  SceneWriter writer(folder, should_stop);
  writer.write(scene);
  if (writer.copied_keys() > Findings::most_copied_keys)
    return fail(ErrorCode::InvalidInput,
                fmt::format("the loops of the scene make {} copied keys; a scene file may have {}",
                            writer.copied_keys(), Findings::most_copied_keys));
  std::string text = writer.text();
  if (is_stopped(should_stop)) return interrupted();
  if (const auto markup = markup_of(text, scene.origin.file, should_stop); !markup)
    return fail(markup.error());
  return text;
}

}  // namespace pliant
