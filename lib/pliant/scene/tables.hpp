#pragma once

#include "pliant/scene/element.hpp"

namespace pliant::xml {

// The attributes of each element, one row each. The default is the present value of the place. A
// new attribute needs a member in scene.hpp, a row here and a row in docs/scene-format.md.

/// The attributes of a <path>.
struct PathText {
  Channel<1> progress = 0;  ///< share of the length, 0 to 1
  bool is_closed = false;
};

/// A <waypoint>.
struct Waypoint {
  Value<3> at = {};  ///< world [length]
};

Table attributes_of(Scene& scene);
Table attributes_of(Surface& surface);
Table attributes_of(GridSheet& grid);
Table attributes_of(MeshFile& mesh, const std::filesystem::path& folder);
Table attributes_of(TransformChannels& transform);
Table attributes_of(MaterialChannels& material);
Table attributes_of(TangentChannels& tangents);
Table attributes_of(SolverSettings& solver);
Table attributes_of(Force& force);  ///< those of all kinds, then those of `force.shape`
Table attributes_of(Group& group);
Table attributes_of(PathText& path);
Table attributes_of(Waypoint& waypoint);

}  // namespace pliant::xml
