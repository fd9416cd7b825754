#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "pliant/document/operation.hpp"
#include "pliant/scene/channels.hpp"
#include "support/random_scene.hpp"

namespace pliant::testing {

/// A random operation on a scene: most are possible, some are not.
class RandomOperation {
 public:
  RandomOperation(const Scene& scene, Chance& chance) : scene_(scene), chance_(chance) {
    for (const Surface& one : scene.surfaces) objects_.push_back(one.name);
    surfaces_ = objects_;
    for (const Force& one : scene.forces) objects_.push_back(one.name);
    for (const Group& one : scene.groups) objects_.push_back(one.name);
    for (const Collider& one : scene.colliders) objects_.push_back(one.name);
    for (const NamedChannel& one : channels_of(scene)) {
      channels_.push_back(one.path);
      if (!one.is_animated()) continue;
      animated_.push_back(one.path);
      std::vector<double>& frames = frames_[one.path];
      const auto add = [&](const auto& curve) {
        for (const auto& key : curve.keys().keys) frames.push_back(key.frame);
      };
      std::visit(
          [&](const auto* channel) {
            if constexpr (std::is_same_v<decltype(channel), const Switch*>)
              add(channel->channel().curve());
            else
              add(channel->curve());
          },
          one.channel);
    }
  }

  Operation make() {
    if (objects_.empty()) return addition();
    switch (chance_.below(animated_.empty() ? 14 : 31)) {
      case 0:
      case 1:
        return edit::Set{chance_.of(channels_), value()};
      case 2:
        return edit::Set{attribute(), value()};
      case 3:
        return edit::Set{chance_.of(channels_) + chance_.pick({".x", ".y", ".z"}), value()};
      case 4:
        return edit::Reset{chance_.once_in(2) ? chance_.of(channels_) : attribute()};
      case 5:
        return edit::Animate{{chance_.of(channels_)}, frame()};
      case 6:
        return chance_.once_in(2) ? addition() : Operation(edit::Delete{{object()}});
      case 7:
        return edit::Duplicate{object(), new_name()};
      case 8:
        return edit::Rename{object(), chance_.once_in(8) ? object() : new_name()};
      case 9:
        return target();
      case 10:
        return group();
      case 11:
        return chance_.once_in(3)
                   ? Operation(edit::Ungroup{{object()}})
                   : Operation(edit::SetKey{chance_.of(channels_), frame(), value()});
      case 12:
        return set_part();
      case 13:
        return edit::Scale{{chance_.of(channels_)}, factor()};
      case 14:
      case 15:
        return edit::SetKey{chance_.of(animated_), frame(), value()};
      case 16:
        return edit::SetKey{chance_.of(animated_), frame()};
      case 17:
        return edit::DeleteKeys{keys()};
      case 18:
        return edit::Scale{{chance_.of(animated_)}, factor()};
      case 19:
        return set_curve();
      case 20:
        return edit::MoveKeys{keys(), chance_.once_in(3) ? 0 : chance_.between(-6, 6) / 2.0, rise(),
                              collision()};
      case 21:
        return edit::ScaleKeys{
            keys(),     frame(), chance_.between(chance_.once_in(20) ? 0 : 1, 6) / 2.0,
            rise(),     rise(),  chance_.between(0, 2) / 2.0,
            collision()};
      case 22:
        return tangent();
      case 23:
        return edit::SetHandle{chance_.of(animated_), old_frame(),
                               chance_.once_in(2) ? edit::Side::In : edit::Side::Out,
                               chance_.pick({"1 2", "-1 2.50", "-1 0 0 0", "2 1 1 1", "3"})};
      case 24:
        return interpolation();
      case 25:
        return edit::SetExtrapolation{{chance_.of(animated_)},
                                      chance_.pick({"hold", "repeat", "slope 1", "mirror 2"}),
                                      chance_.pick({"hold", "linear", "repeatOffset"})};
      case 26:
        return edit::BakeKeys{{chance_.of(animated_)},
                              -1,
                              9,
                              chance_.pick({"1", "2"}) == "1" ? 1.0 : 2.5,
                              chance_.once_in(3)};
      case 27:
        return edit::SimplifyKeys{{chance_.of(animated_)}, chance_.once_in(5) ? 0 : 0.1};
      case 28:
      case 29:
        return splice();
      default:
        return edit::Freeze{{chance_.of(animated_)}, frame()};
    }
  }

 private:
  std::string object() {
    return chance_.once_in(20) ? chance_.pick({"nobody", "scene", ""}) : chance_.of(objects_);
  }
  std::string new_name() {
    return chance_.once_in(15) ? chance_.pick({"", "2", "a b", "a&b", "\xFF"})
                               : fmt::format("new{}", chance_.below(1'000'000));
  }
  std::string attribute() {
    if (chance_.once_in(6))
      return chance_.pick({"scene.fps", "scene.seed", ".end", "scene.version", "nobody.magnitude"});
    if (!surfaces_.empty() && chance_.once_in(2))
      return chance_.of(surfaces_) +
             chance_.pick({".columns", ".rows", ".width", ".dt", ".combine", ".file",
                           ".rotateOrder", ".enabled", ".su0", ".yield", ".preroll", ".name",
                           ".drivenBy", ".wrap", ".integrator", ".border", ".wdith"});
    return chance_.of(objects_) + chance_.pick({".targets", ".falloff", ".seed", ".enabled",
                                                ".center", ".center.closed", ".direction", ".to"});
  }
  std::string value() {
    switch (chance_.below(11)) {
      case 0:
        return chance_.pick({"true", "false", "smooth", "box", "zxy", "exact", "u", "a & 'b'.obj"});
      case 1:
        return chance_.pick(
            {"", "nan", "1,5", "1 2", "-1e300 0 0", "<", "\"'&", "a\nb\r\t", "\x01"});
      case 2:
      case 3:
      case 4:
        return chance_.vector(1, 9);
      case 5:
        return chance_.number(-9, 9);
      default:
        return chance_.number(1, 9);
    }
  }
  double frame() {
    if (chance_.once_in(40)) return std::numeric_limits<double>::infinity();
    return chance_.between(-8, 30) / 2.0;
  }
  double old_frame() {
    const std::string& channel = chance_.of(animated_);
    return chance_.of(frames_[channel]);
  }
  std::vector<double> rise() {
    if (chance_.once_in(3)) return {};
    if (chance_.once_in(3)) return {0.5, 0, -0.25};
    return {chance_.between(-3, 3) / 4.0};
  }
  edit::Collision collision() {
    return chance_.once_in(2) ? edit::Collision::Replace : edit::Collision::Refuse;
  }
  std::vector<edit::KeysOf> keys() {
    std::vector<edit::KeysOf> selection;
    for (int k = chance_.between(1, 2); k > 0; --k) {
      edit::KeysOf some{chance_.of(animated_), {}};
      for (const double frame : frames_[some.channel])
        if (chance_.once_in(2)) some.frames.push_back(frame);
      if (chance_.once_in(30)) some.frames.push_back(1234.5);
      selection.push_back(some);
    }
    return selection;
  }
  Operation tangent() {
    edit::SetTangent set{keys(), edit::Side(chance_.below(3))};
    if (!chance_.once_in(4))
      set.tangent = chance_.pick({"flat", "spline", "1.50", "auto", "0 1 2", "fast"});
    if (chance_.once_in(2)) set.length = chance_.pick({"1", "0.50", "-1"});
    return set;
  }
  Operation interpolation() {
    edit::SetInterpolation set{
        keys(), chance_.pick({"linear", "step", "bezier", "elasticIn", "cubicBezier", "backOut"})};
    if (chance_.once_in(2)) set.control = "0 0 1 1";
    if (set.interpolation != "cubicBezier") set.control.reset();
    return set;
  }
  double factor() {
    if (chance_.once_in(30)) return std::numeric_limits<double>::infinity();
    return chance_.once_in(3) ? chance_.between(1, 4) / 3.0 : chance_.between(-2, 8) / 4.0;
  }
  Operation set_part() {
    if (surfaces_.empty()) return addition();
    edit::SetPart set{chance_.of(surfaces_), "material", {}};
    if (chance_.once_in(8)) set.surface = object();
    if (chance_.once_in(8)) set.part = chance_.pick({"solver", "grid", "transform", ""});
    if (chance_.once_in(2)) set.attributes.emplace_back("density", value());
    if (chance_.once_in(2)) set.attributes.emplace_back("b", chance_.number(1, 9));
    if (chance_.once_in(2)) set.comment = chance_.pick({"soft", "two\nlines", "a -- b", "ends-"});
    return set;
  }
  /// Some of the keys of a curve and others, with all that a curve may have.
  template <int D>
  CurveKeys<D> changed(CurveKeys<D> curve) {
    for (int k = chance_.between(0, 3); k > 0; --k) {
      Key<D> key;
      key.frame = chance_.between(-8, 30) / 2.0;
      key.value.fill(chance_.between(0, 4) / 4.0);
      if (chance_.once_in(4)) key.left = key.value;
      if (chance_.once_in(4)) key.next.kind = Interpolation::Kind::Linear;
      if (chance_.once_in(4)) key.out = {.kind = Tangent<D>::Kind::Slope, .slope = key.value};
      if (chance_.once_in(4)) key.in = {.kind = Tangent<D>::Kind::Flat, .length = 0.5};
      curve.keys.push_back(key);
    }
    std::ranges::stable_sort(curve.keys, {}, &Key<D>::frame);
    const auto is_same = [](const Key<D>& a, const Key<D>& b) { return a.frame == b.frame; };
    curve.keys.erase(std::unique(curve.keys.begin(), curve.keys.end(), is_same), curve.keys.end());
    if (chance_.once_in(3) && curve.keys.size() > 1)
      curve.keys.erase(curve.keys.begin() + chance_.below(static_cast<int>(curve.keys.size())));
    if (chance_.once_in(3))
      curve.after = {.kind = Extrapolation<D>::Kind::Repeat,
                     .count = chance_.once_in(2) ? std::optional(2.0) : std::nullopt};
    if (chance_.once_in(4) && !curve.keys.empty())
      curve.loop = Loop<D>{curve.keys.front().frame, curve.keys.back().frame + 1, 0, 2};
    if (chance_.once_in(4)) curve.loop.reset();
    if (chance_.once_in(4)) curve.overshoot = Overshoot::Contain;
    return curve;
  }
  /// A curve for a channel.
  Operation set_curve() {
    const auto channels = channels_of(scene_);
    const std::string path = chance_.of(chance_.once_in(3) ? channels_ : animated_);
    const auto found = std::ranges::find(channels, path, &NamedChannel::path);
    return std::visit(
        [&]<class One>(const One* one) -> Operation {
          if constexpr (std::is_same_v<One, Switch>) {
            return edit::SetCurve{
                path, changed(one->is_animated() ? one->channel().curve().keys() : CurveKeys<1>{})};
          } else if constexpr (std::is_same_v<One, Channel<1>>) {
            return edit::SetCurve{
                path, changed(one->is_animated() ? one->curve().keys() : CurveKeys<1>{})};
          } else {
            return edit::SetCurve{
                path, changed(one->is_animated() ? one->curve().keys() : CurveKeys<3>{})};
          }
        },
        found->channel);
  }
  /// The same as a piece of the channel's curve.
  Operation splice() {
    auto set = std::get<edit::SetCurve>(set_curve());
    const double first = chance_.between(-8, 20) / 2.0;
    const double last = first + chance_.between(0, 12) / 2.0;
    const auto is_outside = [&](const auto& key) { return key.frame < first || key.frame > last; };
    if (!chance_.once_in(8))
      std::visit([&](auto& keys) { std::erase_if(keys.keys, is_outside); }, set.keys);
    return edit::Splice{set.channel, first, last, set.keys};
  }
  Operation addition() {
    edit::Add add{chance_.pick({"point", "noise", "line", "group", "surface", "collider", "blob"}),
                  new_name()};
    if (add.kind == "surface")
      add.attributes = {{"columns", "5"}, {"density", "2.0"}, {"rows", "4"}, {"enabled", "true"}};
    else
      add.attributes = {{"deformationRadius", "2"}};
    if (!scene_.groups.empty() && chance_.once_in(3)) {
      add.group = chance_.of(scene_.groups).name;
      add.attributes.clear();
    }
    return add;
  }
  Operation target() {
    edit::Target target{{object()}, {}};
    for (const std::string& surface : surfaces_)
      if (chance_.once_in(2)) target.surfaces.push_back(surface);
    return target;
  }
  Operation group() {
    edit::Group group{{}, new_name()};
    for (const Force& force : scene_.forces)
      if (chance_.once_in(3)) group.forces.push_back(force.name);
    if (!scene_.groups.empty() && chance_.once_in(3)) group.name = chance_.of(scene_.groups).name;
    return group;
  }

  const Scene& scene_;
  Chance& chance_;
  std::vector<std::string> objects_, surfaces_, channels_, animated_;
  std::map<std::string, std::vector<double>> frames_;
};

}  // namespace pliant::testing
