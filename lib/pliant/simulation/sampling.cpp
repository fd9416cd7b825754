#include "pliant/simulation/sampling.hpp"

#include <algorithm>
#include <type_traits>

namespace pliant {
namespace {

Vector3d to_vector(const Value<3>& value) { return {value[0], value[1], value[2]}; }

// A tangent of one number applies to all of x, y, z. SPEC 3.
Vector3d sample_tangent(const TangentChannel& channel, int frame) {
  if (const auto* number = std::get_if<Channel<1>>(&channel)) {
    return Vector3d::Constant(number->at(frame)[0]);
  }
  return to_vector(std::get<Channel<3>>(channel).at(frame));
}

struct SampleShape {
  int frame;
  ForceShape operator()(const PointChannels& point) const {
    return PointForce{to_vector(point.center.at(frame)), to_vector(point.direction.at(frame))};
  }
  ForceShape operator()(const RadialChannels& radial) const {
    return RadialForce{to_vector(radial.center.at(frame))};
  }
  ForceShape operator()(const LineChannels& line) const {
    LineForce force{to_vector(line.from.at(frame)), to_vector(line.to.at(frame)), {}};
    if (line.direction) force.direction = to_vector(line.direction->at(frame));
    return force;
  }
};

}  // namespace

SampledForce sample_force(const Force& force, int frame) {
  return {.shape = std::visit(SampleShape{frame}, force.shape),
          .magnitude = force.magnitude.at(frame)[0],
          .deformation_radius = force.deformation_radius.at(frame)[0],
          .force_radius = force.force_radius.at(frame)[0],
          .falloff = force.falloff};
}

bool targets(const Force& force, const std::string& surface) {
  return force.targets.empty() ||
         std::find(force.targets.begin(), force.targets.end(), surface) != force.targets.end();
}

Transform sample_transform(const TransformChannels& channels, int frame) {
  return make_transform(to_vector(channels.translate.at(frame)),
                        to_vector(channels.rotate.at(frame)), to_vector(channels.scale.at(frame)),
                        channels.rotate_order);
}

SurfaceInputs sample_inputs(const Scene& scene, const Surface& surface, int frame) {
  const MaterialChannels& material = surface.material;
  const TangentChannels& tangents = surface.tangents;
  SurfaceInputs inputs;
  inputs.body = {
      .transform = sample_transform(surface.transform, frame),
      .stiffness = {material.b.at(frame)[0], material.c.at(frame)[0], material.d.at(frame)[0]},
      .dynamics = {material.density.at(frame)[0], material.damping.at(frame)[0]},
      .tangents = {sample_tangent(tangents.su0, frame), sample_tangent(tangents.su1, frame),
                   sample_tangent(tangents.sv0, frame), sample_tangent(tangents.sv1, frame)},
      .frame_length = 1 / scene.fps,
      .dt = surface.solver.dt.at(frame)[0],
      .forces = {}};
  for (std::size_t k = 0; k < scene.forces.size(); ++k) {
    const Force& force = scene.forces[k];
    if (!targets(force, surface.name) || !force.enabled.at(frame)) continue;
    inputs.body.forces.push_back(sample_force(force, frame));
    inputs.force_indices.push_back(k);
  }
  return inputs;
}

}  // namespace pliant
