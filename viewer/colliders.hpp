#pragma once

#include <cstddef>
#include <memory>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/simulation/simulation.hpp"
#include "viewer/arrays.hpp"

namespace pliant::viewer {

/// The colliders of a scene as a page draws them: a mesh and its motion, none of a plane, and their
/// values.
///
/// An array with one object for each; docs/viewer.md has its members. Errors: NotFinite beyond
/// single precision; Interrupted.
Result<Json> view_colliders(const Simulation& simulation, const FrameSpan& frames, Arrays& arrays,
                            const StopRequest& should_stop = {});

/// One of them; `mesh`: as in `Simulation::collider_meshes`.
Result<Json> view_collider(const Collider& collider,
                           const std::shared_ptr<const ColliderMesh>& mesh, const FrameSpan& frames,
                           Arrays& arrays, const StopRequest& should_stop = {});

/// What colliders need of a page.
struct ColliderSize {
  std::size_t bytes = 0;            ///< of their meshes
  std::size_t moving_vertices = 0;  ///< of those whose shape moves points
};

/// Errors: those of the caches of meshes.
Result<ColliderSize> size_of_colliders(const Simulation& simulation);

}  // namespace pliant::viewer
