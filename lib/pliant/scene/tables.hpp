#pragma once

#include "pliant/scene/element.hpp"

namespace pliant::xml {

// What each element's attributes are: one row each. The default is the value that the place holds.
// A new attribute is a member in scene.hpp, a row here and a row in docs/scene-format.md.

Table attributes_of(Scene& scene);
Table attributes_of(Surface& surface);
Table attributes_of(GridSheet& grid);
Table attributes_of(MeshFile& mesh, const std::filesystem::path& folder);
Table attributes_of(TransformChannels& transform);
Table attributes_of(MaterialChannels& material);
Table attributes_of(TangentChannels& tangents);
Table attributes_of(SolverSettings& solver);
Table attributes_of(Force& force);  ///< what all kinds share, then what `force.shape` adds

}  // namespace pliant::xml
