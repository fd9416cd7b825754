#include "pliant/scene/checks/channel_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/transform.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/plate/time_steps.hpp"
#include "pliant/scene/format/description.hpp"

namespace pliant {
namespace {

// The problem of a value, in words that follow "NAME.attribute at frame F"; null: no problem.
using Problem = std::optional<std::string>;

template <int D>
std::string spelled(const Value<D>& value) {
  return fmt::format("{}", fmt::join(value, " "));
}

template <int D>
bool is_finite(const Value<D>& value) {
  for (const double component : value) {
    if (!std::isfinite(component)) return false;
  }
  return true;
}

class ChannelChecker {
 public:
  /// At one frame, or at all that are sampled.
  ChannelChecker(const Scene& scene, std::optional<int> frame, const ChannelFilter& is_checked,
                 const StopRequest& should_stop)
      : scene_(scene), frame_(frame), is_checked_(is_checked), poll_(should_stop) {}

  void check_all() {
    for (const Surface& surface : scene_.surfaces) {
      set_frames(sampled_frames(scene_, surface));
      check(surface);
    }
    set_frames(sampled_frames(scene_));
    for (const Force& force : scene_.forces) check_channels(force, force);
    for (const Group& group : scene_.groups) check_channels(group, group);
    ++last_;  // a collider goes to where it is in the next frame
    for (const Collider& collider : scene_.colliders) check(collider);
  }

  std::vector<Error> take_errors() {
    if (poll_.after(0)) return {interrupted().value()};
    return std::move(errors_);
  }

 private:
  void set_frames(const FrameSpan& frames) {
    first_ = frame_.value_or(frames.first);
    last_ = frame_.value_or(frames.last);
  }

  void check(const Surface& surface) {
    check_channels(surface, surface.transform);
    check_channels(surface, surface.material);
    const bool has_stiffness = kept_.contains("b") && kept_.contains("d");
    if (has_stiffness && check_ellipticity(surface) && kept_.contains("poisson")) {
      check_poisson(surface);
    }
    if (kept_.contains("hardening")) check_hardening(surface);
    if (kept_.contains("density") && kept_.contains("damping") && kept_.contains("goal"))
      check_is_held(surface);
    check_channels(surface, surface.tangents);
    check_channels(surface, surface.solver);
    if (kept_.contains("dt") && kept_.contains("timeScale")) check_steps(surface);
  }

  void check(const Collider& collider) {
    check_channels(collider, collider);
    if (!kept_.contains("scale")) return;
    if (!std::holds_alternative<PlaneChannels>(collider.shape) &&
        !std::holds_alternative<BoxChannels>(collider.shape) &&
        !std::holds_alternative<ClosedMesh>(collider.shape)) {
      check(collider.name, "scale", collider.transform.scale,
            [](const Value<3>& scale) { return complaint_of_uneven(scale); });
    }
    const auto* const box = std::get_if<BoxChannels>(&collider.shape);
    if (box && kept_.contains("size") && kept_.contains("round")) check_round(collider, *box);
  }

  static Problem complaint_of_uneven(const Value<3>& scale) {
    const double size = std::abs(scale[0]);
    const auto is_equal = [&](double other) {
      return std::abs(std::abs(other) - size) <= 1e-9 * size;
    };
    if (is_equal(scale[1]) && is_equal(scale[2])) return {};
    return fmt::format("is {}, but must be equal along x, y and z: use equal scales, or a mesh",
                       fmt::join(scale, " "));
  }

  void check_round(const Collider& collider, const BoxChannels& box) {
    const Channel<3>& scale = collider.transform.scale;
    const bool is_animated =
        box.round.is_animated() || box.size.is_animated() || scale.is_animated();
    const int last = is_animated ? last_ : first_;
    for (int frame = first_; frame <= last && !poll_.after(parts_of_frame); ++frame) {
      const double round = box.round.at(frame)[0];
      const Value<3> size = box.size.at(frame), scales = scale.at(frame);
      double most = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < 3; ++k) most = std::min(most, size[k] * std::abs(scales[k]) / 2);
      if (round <= most * (1 + 1e-9)) continue;
      return add_error(collider.name, "round", is_animated, frame,
                       fmt::format("is {}, but must be at most {}, half the least length of the "
                                   "box",
                                   round, most),
                       scene_.origin.last_of(collider.name, {"round", "size", "scale"}));
    }
  }

  // The channels of a part of a surface, or of a force, group or collider. Notes which keep their
  // rule.
  template <class Owner, class Part>
  void check_channels(const Owner& owner, const Part& part) {
    kept_.clear();
    for_each_channel(
        part, [&]<class C>(const std::string& name, const Attribute& attribute, const C& channel) {
          if constexpr (!std::is_same_v<C, Switch>) {
            const auto rule = [&](const auto& value) { return complaint(owner, attribute, value); };
            if (check(owner.name, name, channel, rule)) kept_.insert(name);
          }
        });
  }

  // The rules of single channels: their ranges, and those that need more than a range.
  template <class Owner, std::size_t D>
  Problem complaint(const Owner& owner, const Attribute& attribute,
                    const std::array<double, D>& value) const {
    if constexpr (std::is_same_v<Owner, Surface> || std::is_same_v<Owner, Collider>) {
      if (attribute.name == "scale") return complaint_of_scale(value);
    }
    if constexpr (std::is_same_v<Owner, Surface>) {
      if (attribute.unit == edge_slope) return complaint_of_tangent(owner, attribute.name, value);
      const bool has_rest = owner.solver.reference == Reference::Rest;
      if (attribute.name == "goal" && !has_rest && value[0] != 0)
        return fmt::format(
            "is {}, but must be 0 with reference=\"none\", which has no shape at rest to pull back "
            "to",
            value[0]);
    }
    if (const auto rule = attribute.range.broken_rule(value))
      return fmt::format("is {}, but {}", spelled<D>(value), *rule);
    return {};
  }

  static Problem complaint_of_scale(std::span<const double> scale) {
    const Transform transform = make_transform(Vector3d::Zero(), Vector3d::Zero(),
                                               {scale[0], scale[1], scale[2]}, RotateOrder::Xyz);
    if (transform.is_invertible()) return {};
    return fmt::format("is {}, but must not be 0, nor so near 0 that its inverse is not finite",
                       fmt::join(scale, " "));
  }

  // A body with tangents never comes to rest, so it cannot recover: SPEC 6. Only a clamped edge has
  // a slope that is given: SPEC 9.
  static Problem complaint_of_tangent(const Surface& surface, std::string_view name,
                                      std::span<const double> slopes) {
    if (std::all_of(slopes.begin(), slopes.end(), [](double x) { return x == 0; })) return {};
    const auto refused = [&](std::string_view reason) {
      return fmt::format("is {}, but must be 0 {}", fmt::join(slopes, " "), reason);
    };
    if (surface.solver.release == Release::Recover) return refused("with release=\"recover\"");
    const Border border = surface.reading.border.value_or(Border::Clamped);
    if (surface.solver.region == SolvedRegion::All && border != Border::Clamped)
      return refused(fmt::format("at a border that is {}, as region=\"all\" leaves it",
                                 border_words[static_cast<std::size_t>(border)]));
    const auto& [u0, u1, v0, v1] = surface.solver.edges;
    const Edge edge = name == "su0" ? u0 : name == "su1" ? u1 : name == "sv0" ? v0 : v1;
    if (edge == Edge::Clamped) return {};
    return refused(fmt::format("at an edge that edges makes {}",
                               border_words[static_cast<std::size_t>(edge)]));
  }

  // Whether the channel keeps `rule` at every frame; a constant one is checked once.
  template <int D, class Rule>
  bool check(const std::string& name, std::string_view attribute, const Channel<D>& channel,
             const Rule& rule) {
    if (!is_checked(name, attribute)) return false;
    const int last = channel.is_animated() ? last_ : first_;
    for (int frame = first_; frame <= last && !poll_.after(parts_of_frame); ++frame) {
      const Value<D> value = channel.at(frame);
      const Problem complaint = is_finite<D>(value)
                                    ? rule(value)
                                    : fmt::format("is {}, which is not finite", spelled<D>(value));
      if (complaint) {
        add_error(name, attribute, channel.is_animated(), frame, *complaint,
                  scene_.origin.at(name, std::string(attribute)));
        return false;
      }
    }
    return true;
  }

  void check_steps(const Surface& surface) {
    const Channel<1>& dt = surface.solver.dt;
    const Channel<1>& time_scale = surface.solver.time_scale;
    const bool is_animated = dt.is_animated() || time_scale.is_animated();
    const int last = is_animated ? last_ : first_;
    for (int frame = first_; frame <= last && !poll_.after(parts_of_frame); ++frame) {
      const double length = frame_length(scene_, surface, frame);
      if (length == 0) continue;
      const auto checked = check_time_step(length, dt.at(frame)[0]);
      if (checked) continue;
      return add_error(surface.name, "dt", is_animated, frame, checked.error().message,
                       scene_.origin.last_of(surface.name, {"dt", "timeScale"}));
    }
  }

  // Whether it holds.
  bool check_ellipticity(const Surface& surface) {
    if (!is_checked(surface.name, "c")) return false;
    const auto& [b, c, d] = std::tie(surface.material.b, surface.material.c, surface.material.d);
    const bool is_animated = b.is_animated() || c.is_animated() || d.is_animated();
    const int last = is_animated ? last_ : first_;
    for (int frame = first_; frame <= last && !poll_.after(parts_of_frame); ++frame) {
      const Stiffness stiffness{b.at(frame)[0], c.at(frame)[0], d.at(frame)[0]};
      if (!stiffness.is_elliptic() || !std::isfinite(stiffness.c)) {
        add_error(surface.name, "c", is_animated, frame,
                  fmt::format("is {}, but must be greater than -2 sqrt(b d) = {} (b = {}, d = {}); "
                              "otherwise the plate has no stable shape",
                              stiffness.c, stiffness.least_c(), stiffness.b, stiffness.d),
                  scene_.origin.last_of(surface.name, {"b", "c", "d"}));
        return false;
      }
    }
    return true;
  }

  // Where it acts. Requires: the stiffness is elliptic.
  void check_poisson(const Surface& surface) {
    const bool has_free_edge = surface.solver.edges.have_free();
    const bool has_free_border = surface.reading.border == Border::Free;
    const auto& [b, c, d] = std::tie(surface.material.b, surface.material.c, surface.material.d);
    const auto& [yield, poisson] = std::tie(surface.material.yield, surface.material.poisson);
    if (!has_free_edge && !has_free_border && !yield) return;
    const char* const where = has_free_edge     ? "a free edge"
                              : has_free_border ? "a free border"
                                                : "yield";
    const bool is_animated =
        b.is_animated() || c.is_animated() || d.is_animated() || poisson.is_animated();
    const int last = is_animated ? last_ : first_;
    for (int frame = first_; frame <= last && !poll_.after(parts_of_frame); ++frame) {
      const double ratio = poisson.at(frame)[0];
      const Stiffness stiffness{b.at(frame)[0], c.at(frame)[0], d.at(frame)[0]};
      // -least_c() = 2 sqrt(b d).
      const double least_c = -ratio * stiffness.least_c();
      if (std::abs(ratio) < 1 && stiffness.c > least_c) continue;
      return add_error(surface.name, "poisson", is_animated, frame,
                       fmt::format("is {}, but with {} it must be between -1 and 1, and c = {} "
                                   "must be greater than 2 poisson sqrt(b d) = {}; a smaller "
                                   "poisson helps",
                                   ratio, where, stiffness.c, least_c),
                       scene_.origin.last_of(surface.name, {"poisson", "b", "c", "d"}));
    }
  }

  // What is static and yields has one shape only if it hardens.
  void check_hardening(const Surface& surface) {
    const MaterialChannels& material = surface.material;
    if (!material.yield) return;
    const auto& [density, hardening] = std::tie(material.density, material.hardening);
    const Channel<1>& damping = material.damping_ratio ? density : material.damping;
    const bool is_animated =
        density.is_animated() || damping.is_animated() || hardening.is_animated();
    const int last = is_animated ? last_ : first_;
    for (int frame = first_; frame <= last && !poll_.after(parts_of_frame); ++frame) {
      const bool is_static = density.at(frame)[0] == 0 && damping.at(frame)[0] == 0;
      if (!is_static || hardening.at(frame)[0] > 0) continue;
      return add_error(surface.name, "hardening", is_animated, frame,
                       "is 0, but must be greater than 0 where density and damping are 0: nothing "
                       "else says how far a static surface yields",
                       scene_.origin.last_of(surface.name, {"density", "damping", "hardening"}));
    }
  }

  // A static surface that is solved as a whole needs edges or a goal that hold it: SPEC 9,
  // "Whole-body motion".
  void check_is_held(const Surface& surface) {
    const SolverSettings& solver = surface.solver;
    // What nodes hold is seen once they are known.
    if (solver.region != SolvedRegion::All || solver.edges.hold() || !surface.holds.empty()) return;
    if (const auto found = static_frame_of(scene_, surface, {first_, last_}))
      errors_.push_back(not_held(scene_, surface, *found, {}));
  }

  bool is_checked(const std::string& name, std::string_view attribute) {
    if (poll_.after(StopPoll::parts_between)) return false;
    return !is_checked_ || is_checked_(name, attribute);
  }

  void add_error(const std::string& name, std::string_view attribute, bool is_animated, int frame,
                 const std::string& complaint, const TextPlace& place) {
    const std::string when = is_animated ? fmt::format(" at frame {}", frame) : "";
    errors_.push_back(scene_.origin.located(
        {.code = ErrorCode::InvalidInput,
         .message = fmt::format("{}.{}{} {}", name, attribute, when, complaint)},
        place));
  }

  static constexpr std::size_t parts_of_frame = 500;

  const Scene& scene_;
  std::optional<int> frame_;  // null: all that are sampled
  int first_ = 0, last_ = 0;  // the present part's
  const ChannelFilter& is_checked_;
  StopPoll poll_;
  std::set<std::string, std::less<>> kept_;  // channels of the present part that keep their rule
  std::vector<Error> errors_;
};

}  // namespace

std::optional<StaticFrame> static_frame_of(const Scene& scene, const Surface& surface,
                                           const FrameSpan& frames, bool has_goal) {
  if (!surface.enabled || surface.is_driven()) return {};
  const MaterialChannels& material = surface.material;
  const Channel<1>& density = material.density;
  const Channel<1>& damping = material.damping_ratio ? density : material.damping;
  const bool is_animated = density.is_animated() || damping.is_animated() ||
                           material.goal.is_animated() || surface.solver.time_scale.is_animated();
  const int first = std::max(frames.first, first_solved_frame(scene, surface));
  const int last = is_animated ? frames.last : std::min(first, frames.last);
  for (int frame = first; frame <= last; ++frame) {
    if (density.at(frame)[0] != 0 || damping.at(frame)[0] != 0) continue;
    if ((material.goal.at(frame)[0] != 0) != has_goal) continue;
    if (frame_length(scene, surface, frame) != 0) return StaticFrame{frame, is_animated};
  }
  return {};
}

Error not_held(const Scene& scene, const Surface& surface, const StaticFrame& at,
               std::string_view part) {
  const std::string when = at.is_animated ? fmt::format(" at frame {}", at.frame) : "";
  const std::string what = part.empty() ? "a static surface" : std::string(part);
  const bool is_grid = part.empty();
  const bool has_goal = surface.material.goal.at(at.frame)[0] != 0;
  return scene.origin.located(
      {.code = ErrorCode::InvalidInput,
       .message = fmt::format(
           "{}.density{} is 0, and so is damping, but nothing holds {}: give it a "
           "density or a damping, {}{}",
           surface.name, when, what,
           !surface.holds.empty() ? "or a <hold> or a goal at nodes that are not in one line"
           : has_goal             ? "or a goal at nodes that are not in one line"
                                  : "or a goal",
           is_grid ? ", or a clamped edge or two pinned ones" : "")},
      scene.origin.last_of(surface.name, {"density", "damping", "goal"}));
}

std::vector<Error> check_channels(const Scene& scene, const ChannelFilter& is_checked,
                                  const StopRequest& should_stop) {
  ChannelChecker checker(scene, {}, is_checked, should_stop);
  checker.check_all();
  return checker.take_errors();
}

std::vector<Error> check_channels_at(const Scene& scene, int frame,
                                     const ChannelFilter& is_checked) {
  const StopRequest never;
  ChannelChecker checker(scene, frame, is_checked, never);
  checker.check_all();
  return checker.take_errors();
}

}  // namespace pliant
