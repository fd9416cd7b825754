#pragma once

#include <cstddef>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

// From channels to the values of one frame; not for other rooms.

/// What acts on `surface` at `frame`.
struct SurfaceInputs {
  BodyInputs body;
  std::vector<std::size_t> force_indices;  ///< of `body.forces` in `scene.forces`
};
SurfaceInputs sample_inputs(const Scene& scene, const Surface& surface, int frame);

SampledForce sample_force(const Force& force, int frame);

Transform sample_transform(const TransformChannels& channels, int frame);

/// Whether a force acts on a surface at all.
bool targets(const Force& force, const std::string& surface);

}  // namespace pliant
