#pragma once

#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "pliant/pliant.hpp"
#include "pliant/scene/format/description.hpp"

namespace pliant::testing {

/// All that a scene says, as texts by path, to the bit: two scenes that say the same are the same,
/// but for the lines and notes of their files.
class SceneValues {
 public:
  explicit SceneValues(const Scene& scene) {
    add_rows("scene", scene);
    std::string order;
    for (const Surface& surface : scene.surfaces) {
      const std::string& name = surface.name;
      order += name + ' ';
      add_rows(name, surface);
      std::visit([&](const auto& shape) { add_shape(name, shape); }, surface.shape);
      add_rows(name, surface.reading);
      if (surface.subdivision) add_rows(name, *surface.subdivision);
      add_rows(name, surface.cache);
      add_rows(name, surface.transform);
      add_rows(name, surface.material);
      add_rows(name, surface.tangents);
      add_rows(name, surface.solver);
      for (const MaterialMap& map : surface.maps) add_rows(name + '.' + name_of(map.channel), map);
    }
    for (const Force& force : scene.forces) {
      order += force.group + '/' + force.name + ' ';
      texts_[force.name] = kind_of(force);
      add_rows(force.name, force);
      std::visit([&](const auto& kind) { add_rows(force.name, kind); }, force.kind);
      if (force.falloff_curve) texts_[force.name + ".falloff"] = text(*force.falloff_curve);
    }
    for (const Group& group : scene.groups) {
      order += group.name + ' ';
      add_rows(group.name, group);
    }
    for (const Collider& collider : scene.colliders) {
      order += collider.name + ' ';
      texts_[collider.name] = shape_of(collider);
      for_each_part(collider, [&](const auto& part) { add_rows(collider.name, part); });
    }
    texts_["order"] = order;
  }

  const std::map<std::string, std::string>& texts() const { return texts_; }

  friend bool operator==(const SceneValues&, const SceneValues&) = default;

  static std::string text(double number) { return fmt::format("{}", number); }
  static std::string text(bool value) { return value ? "true" : "false"; }
  static std::string text(const std::string& value) { return value; }
  template <class T>
  requires std::is_enum_v<T> || std::is_integral_v<T>
  static std::string text(T value) {
    if constexpr (std::is_enum_v<T>)
      return fmt::format("{}", static_cast<int>(value));
    else
      return fmt::format("{}", value);
  }
  template <class T>
  static std::string text(const std::optional<T>& value) {
    return value ? text(*value) : "none";
  }
  template <class T>
  static std::string text(const std::vector<T>& values) {
    std::string all;
    for (const T& value : values) all += text(value) + ' ';
    return all;
  }
  template <std::size_t D>
  static std::string text(const std::array<double, D>& value) {
    return fmt::format("{}", fmt::join(value, " "));
  }
  static std::string text(const Edges& edges) {
    return text(edges.u0) + text(edges.u1) + text(edges.v0) + text(edges.v1);
  }
  template <int D>
  static std::string text(const Tangent<D>& tangent) {
    return fmt::format("{} [{}] {} {} {}", text(tangent.kind), text(tangent.slope),
                       text(tangent.length), tangent.handle_frames, text(tangent.handle_value));
  }
  static std::string text(const Interpolation& of) {
    return fmt::format("{} {} {} {} {} {} {}", text(of.kind), text(of.ease), text(of.side),
                       text(of.amplitude), text(of.period), text(of.back), text(of.control));
  }
  template <int D>
  static std::string text(const Extrapolation<D>& of) {
    return fmt::format("{} {} {}", text(of.kind), text(of.slope), text(of.count));
  }
  template <int D>
  static std::string text(const Curve<D>& curve) {
    const CurveKeys<D>& keys = curve.keys();
    std::string all = fmt::format("before {} after {} overshoot {}", text(keys.before),
                                  text(keys.after), text(keys.overshoot));
    if (keys.loop)
      all += fmt::format("\nloop {} {} {} {} {}", keys.loop->from, keys.loop->to, keys.loop->before,
                         keys.loop->after, text(keys.loop->offset));
    for (const Key<D>& key : keys.keys)
      all += fmt::format("\n{}: {} next {} in {} out {} left {}", key.frame, text(key.value),
                         text(key.next), text(key.in), text(key.out),
                         key.left ? text(*key.left) : "none");
    return all;
  }
  template <int D>
  static std::string text(const Channel<D>& channel) {
    return channel.is_animated() ? text(channel.curve()) : text(channel.at(0));
  }
  static std::string text(const Switch& channel) { return text(channel.channel()); }
  static std::string text(const TangentChannel& tangent) {
    return std::visit([](const auto& channel) { return text(channel); }, tangent);
  }

 private:
  template <class Thing>
  void add_rows(const std::string& name, const Thing& thing) {
    const auto row = [&](const Attribute& attribute, const auto&... member) {
      (add(fmt::format("{}.{}", name, attribute.name), member), ...);
    };
    describe(row, thing);
  }
  template <class T>
  void add(const std::string& path, const T& value) {
    texts_[path] = text(value);
  }
  void add(const std::string& path, const PositionChannel& position) {
    if (position.channel()) return add(path, *position.channel());
    texts_[path] = "along " + text(position.path()->path.waypoints());
    texts_[path + ".closed"] = text(position.path()->path.is_closed());
    texts_[path + ".progress"] = text(position.path()->progress);
  }
  void add_shape(const std::string& name, const GridSheet& sheet) { add_rows(name, sheet); }
  void add_shape(const std::string& name, const MeshFile& mesh) { add_rows(name, mesh); }
  void add_shape(const std::string& name, const NurbsNet& net) {
    add_rows(name, net);
    for (const NurbsDirection* const direction : {&net.u, &net.v}) {
      const std::string along = direction == &net.u ? "U" : "V";
      texts_[name + ".wrap" + along] = text(direction->is_closed);
      texts_[name + ".knots" + along] = text(direction->knots);
    }
    texts_[name + ".weights"] = text(net.weights);
    std::string points;
    for (const double coordinate : net.points.reshaped()) points += text(coordinate) + ' ';
    texts_[name + ".points"] = points;
  }
  void add_shape(const std::string& name, const Mesh&) { texts_[name + ".shape"] = "of a program"; }

  std::map<std::string, std::string> texts_;
};

}  // namespace pliant::testing
