#include "pliant/scene/channels.hpp"

#include <type_traits>
#include <utility>

namespace pliant {
namespace {

class ChannelList {
 public:
  void add(const Surface& surface) {
    owner_ = &surface.name;
    add("translate", surface.transform.translate);
    add("rotate", surface.transform.rotate);
    add("scale", surface.transform.scale);
    add("density", surface.material.density);
    add("damping", surface.material.damping);
    add("b", surface.material.b);
    add("c", surface.material.c);
    add("d", surface.material.d);
    add("su0", surface.tangents.su0);
    add("su1", surface.tangents.su1);
    add("sv0", surface.tangents.sv0);
    add("sv1", surface.tangents.sv1);
    add("dt", surface.solver.dt);
  }

  void add(const Force& force) {
    owner_ = &force.name;
    add("enabled", force.enabled);
    add("magnitude", force.magnitude);
    if (force.group.empty()) add("deformationRadius", force.deformation_radius);
    add("forceRadius", force.force_radius);
    std::visit([&](const auto& shape) { add_shape(shape); }, force.shape);
  }

  void add(const Group& group) {
    owner_ = &group.name;
    add("enabled", group.enabled);
    add("center", group.center);
    add("deformationRadius", group.deformation_radius);
  }

  std::vector<NamedChannel> take() { return std::move(channels_); }

 private:
  void add_shape(const PointChannels& point) {
    add("center", point.center);
    add("direction", point.direction);
  }
  void add_shape(const RadialChannels& radial) { add("center", radial.center); }
  void add_shape(const LineChannels& line) {
    add("from", line.from);
    add("to", line.to);
    if (line.direction) add("direction", *line.direction);
  }

  void add_shape(const UniformChannels& uniform) { add("direction", uniform.direction); }
  void add_shape(const VortexChannels& vortex) {
    add("center", vortex.center);
    add("axis", vortex.axis);
    add("pull", vortex.pull);
  }
  void add_shape(const NoiseChannels& noise) {
    add("center", noise.center);
    add("frequency", noise.frequency);
    add("rate", noise.rate);
  }
  void add_shape(const InertiaChannels&) {}
  void add_shape(const CustomForce&) {}

  void add(const std::string& attribute, const PositionChannel& position) {
    if (const PathMotion* motion = position.path()) {
      add(attribute + ".progress", motion->progress);
    } else {
      add(attribute, *position.channel());
    }
  }
  void add(const std::string& attribute, const TangentChannel& tangent) {
    std::visit([&](const auto& channel) { add(attribute, channel); }, tangent);
  }
  template <class C>
  void add(const std::string& attribute, const C& channel) {
    channels_.push_back({*owner_ + '.' + attribute, &channel});
  }

  const std::string* owner_ = nullptr;
  std::vector<NamedChannel> channels_;
};

}  // namespace

bool NamedChannel::is_animated() const {
  return std::visit(
      [](const auto* held) {
        if constexpr (std::is_same_v<decltype(held), const Switch*>) {
          return held->channel().is_animated();
        } else {
          return held->is_animated();
        }
      },
      channel);
}

std::vector<NamedChannel> channels_of(const Scene& scene) {
  ChannelList list;
  for (const Surface& surface : scene.surfaces) list.add(surface);
  for (const Force& force : scene.forces) list.add(force);
  for (const Group& group : scene.groups) list.add(group);
  return list.take();
}

}  // namespace pliant
