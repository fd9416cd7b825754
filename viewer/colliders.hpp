#pragma once

#include <cstddef>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/simulation.hpp"
#include "viewer/arrays.hpp"

namespace pliant::viewer {

/// The colliders of a scene as a page draws them: a mesh and its motion, none of a plane, and their
/// values.
///
/// An array with one object for each; docs/viewer.md has its members. Errors: NotFinite beyond
/// single precision; Interrupted.
Result<Json> view_colliders(const Scene& scene, const FrameSpan& frames, Arrays& arrays,
                            const StopRequest& should_stop = {});

/// The vertices of those whose shape moves points, for the memory that their motion needs.
std::size_t moving_vertices(const Scene& scene);

}  // namespace pliant::viewer
