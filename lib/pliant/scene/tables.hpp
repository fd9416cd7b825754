#pragma once

#include "pliant/scene/element.hpp"

namespace pliant::xml {

// What each element's attributes are: one row each. The default is the value that the place holds.
// A new attribute is a member in scene.hpp, a row here and a row in docs/scene-format.md.

/// What a <path> says besides its waypoints.
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
Table attributes_of(Force& force);  ///< what all kinds share, then what `force.shape` adds
Table attributes_of(Group& group);
Table attributes_of(PathText& path);
Table attributes_of(Waypoint& waypoint);

}  // namespace pliant::xml
