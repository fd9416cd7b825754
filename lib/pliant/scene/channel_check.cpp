#include "pliant/scene/channel_check.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/transform.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/plate/time_steps.hpp"

namespace pliant {
namespace {

// The problem of a value, in words that follow "NAME.attribute at frame F"; null: no problem.
using Complaint = std::optional<std::string>;

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

Complaint at_least_zero(const Value<1>& value) {
  if (value[0] >= 0) return {};
  return fmt::format("is {}, but must be at least 0", value[0]);
}

Complaint greater_than_zero(const Value<1>& value) {
  if (value[0] > 0) return {};
  return fmt::format("is {}, but must be greater than 0", value[0]);
}

Complaint a_share_of_the_way(const Value<1>& value) {
  if (value[0] >= 0 && value[0] <= 1) return {};
  return fmt::format("is {}, but must be from 0 to 1", value[0]);
}

template <int D>
Complaint anything(const Value<D>&) {
  return {};
}

class ChannelChecker {
 public:
  ChannelChecker(const Scene& scene, const ChannelFilter& is_checked,
                 const StopRequest& should_stop)
      : scene_(scene), is_checked_(is_checked), should_stop_(should_stop) {}

  void check(const Surface& surface) {
    check(surface.name, "translate", surface.transform.translate, anything<3>);
    check(surface.name, "rotate", surface.transform.rotate, anything<3>);
    check(surface.name, "scale", surface.transform.scale, [](const Value<3>& scale) -> Complaint {
      const Transform transform = make_transform(Vector3d::Zero(), Vector3d::Zero(),
                                                 {scale[0], scale[1], scale[2]}, RotateOrder::Xyz);
      if (transform.is_invertible()) return {};
      return fmt::format("is {}, but must not be 0, nor so near 0 that its inverse is not finite",
                         spelled<3>(scale));
    });
    const MaterialChannels& material = surface.material;
    check(surface.name, "density", material.density, at_least_zero);
    check(surface.name, "damping", material.damping, at_least_zero);
    const bool b_is_good = check(surface.name, "b", material.b, greater_than_zero);
    const bool d_is_good = check(surface.name, "d", material.d, greater_than_zero);
    if (b_is_good && d_is_good) check_ellipticity(surface);
    for (const auto& [attribute, tangent] :
         {std::pair{"su0", &surface.tangents.su0}, std::pair{"su1", &surface.tangents.su1},
          std::pair{"sv0", &surface.tangents.sv0}, std::pair{"sv1", &surface.tangents.sv1}}) {
      std::visit(
          [&, name = attribute](const auto& channel) { check_tangent(surface, name, channel); },
          *tangent);
    }
    check(surface.name, "dt", surface.solver.dt, [&](const Value<1>& dt) -> Complaint {
      const auto checked = check_time_step(1 / scene_.fps, dt[0]);
      return checked ? Complaint{} : checked.error().message;
    });
  }

  void check(const Force& force) {
    check(force.name, "magnitude", force.magnitude, anything<1>);
    if (force.group.empty()) {
      check(force.name, "deformationRadius", force.deformation_radius, at_least_zero);
    }
    check(force.name, "forceRadius", force.force_radius, at_least_zero);
    std::visit([&](const auto& shape) { check_shape(force.name, shape); }, force.shape);
  }

  void check(const Group& group) {
    check_position(group.name, "center", group.center);
    check(group.name, "deformationRadius", group.deformation_radius, at_least_zero);
  }

  std::vector<Error> take_errors() { return std::move(errors_); }

 private:
  void check_shape(const std::string& name, const PointChannels& point) {
    check_position(name, "center", point.center);
    check(name, "direction", point.direction, anything<3>);
  }
  void check_shape(const std::string& name, const RadialChannels& radial) {
    check_position(name, "center", radial.center);
  }
  void check_shape(const std::string& name, const LineChannels& line) {
    check_position(name, "from", line.from);
    check_position(name, "to", line.to);
    if (line.direction) check(name, "direction", *line.direction, anything<3>);
  }
  void check_shape(const std::string& name, const UniformChannels& uniform) {
    check(name, "direction", uniform.direction, anything<3>);
  }
  void check_shape(const std::string& name, const VortexChannels& vortex) {
    check_position(name, "center", vortex.center);
    check(name, "axis", vortex.axis, anything<3>);
    check(name, "pull", vortex.pull, anything<1>);
  }
  void check_shape(const std::string& name, const NoiseChannels& noise) {
    check_position(name, "center", noise.center);
    check(name, "frequency", noise.frequency, anything<1>);
    check(name, "rate", noise.rate, anything<1>);
  }
  void check_shape(const std::string&, const InertiaChannels&) {}
  void check_shape(const std::string&, const CustomForce&) {}

  void check_position(const std::string& name, const std::string& attribute,
                      const PositionChannel& position) {
    if (const PathMotion* motion = position.path()) {
      check(name, attribute + ".progress", motion->progress, a_share_of_the_way);
    } else {
      check(name, attribute, *position.channel(), anything<3>);
    }
  }

  // A body with tangents never comes to rest, so it cannot recover: SPEC 6.
  template <int D>
  void check_tangent(const Surface& surface, std::string_view attribute,
                     const Channel<D>& channel) {
    if (surface.solver.release == Release::Freeze) {
      check(surface.name, attribute, channel, anything<D>);
      return;
    }
    check(surface.name, attribute, channel, [](const Value<D>& value) -> Complaint {
      if (value == Value<D>{}) return {};
      return fmt::format("is {}, but must be 0 with release=\"recover\"", spelled<D>(value));
    });
  }

  // Whether the channel keeps `rule` at every frame; a constant one is checked once.
  template <int D, class Rule>
  bool check(const std::string& name, std::string_view attribute, const Channel<D>& channel,
             const Rule& rule) {
    if (!is_checked(name, attribute)) return false;
    const int last = channel.is_animated() ? scene_.end : scene_.start;
    for (int frame = scene_.start; frame <= last; ++frame) {
      const Value<D> value = channel.at(frame);
      const Complaint complaint =
          is_finite<D>(value) ? rule(value)
                              : fmt::format("is {}, which is not finite", spelled<D>(value));
      if (complaint) {
        add_error(name, attribute, frame, *complaint);
        return false;
      }
    }
    return true;
  }

  void check_ellipticity(const Surface& surface) {
    if (!is_checked(surface.name, "c")) return;
    const auto& [density, damping, b, c, d] = surface.material;
    const bool is_animated = b.is_animated() || c.is_animated() || d.is_animated();
    const int last = is_animated ? scene_.end : scene_.start;
    for (int frame = scene_.start; frame <= last; ++frame) {
      const Stiffness stiffness{b.at(frame)[0], c.at(frame)[0], d.at(frame)[0]};
      if (!stiffness.is_elliptic() || !std::isfinite(stiffness.c)) {
        return add_error(surface.name, "c", frame,
                         fmt::format("is {}, but must be greater than -2 sqrt(b d) = {} (b = {}, "
                                     "d = {})",
                                     stiffness.c, stiffness.least_c(), stiffness.b, stiffness.d));
      }
    }
  }

  bool is_checked(const std::string& name, std::string_view attribute) const {
    if (should_stop_ && should_stop_()) return false;
    return !is_checked_ || is_checked_(name, attribute);
  }

  void add_error(const std::string& name, std::string_view attribute, int frame,
                 const std::string& complaint) {
    errors_.push_back(
        {.code = ErrorCode::InvalidInput,
         .message = fmt::format("{}.{} at frame {} {}", name, attribute, frame, complaint),
         .file = scene_.origin.file,
         .line = scene_.origin.line_of(name, std::string(attribute))});
  }

  const Scene& scene_;
  const ChannelFilter& is_checked_;
  const StopRequest& should_stop_;
  std::vector<Error> errors_;
};

}  // namespace

std::vector<Error> check_channels(const Scene& scene, const ChannelFilter& is_checked,
                                  const StopRequest& should_stop) {
  ChannelChecker checker(scene, is_checked, should_stop);
  for (const Surface& surface : scene.surfaces) checker.check(surface);
  for (const Force& force : scene.forces) checker.check(force);
  for (const Group& group : scene.groups) checker.check(group);
  return checker.take_errors();
}

}  // namespace pliant
