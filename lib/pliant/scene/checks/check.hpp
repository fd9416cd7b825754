#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// Checks the rules for a scene as a whole: every number that is no channel is within its range
/// (docs/scene-format.md); start <= end, at most `max_frames` frames; names well formed and unique
/// over surfaces, forces and groups; targets and groups exist; a custom force has a function; a
/// sheet has at most `max_sheet_vertices` vertices. The reader has done so for a scene from a file.
/// `Simulation::make` checks the channels over the frames. Returns all problems, in the order of
/// their lines; fewer if the caller wants it to stop.
std::vector<Error> check_scene(const Scene& scene, const StopRequest& should_stop = {});

/// `surface "sheet"`, or `collider "ball"`: what names a mesh file, for messages.
std::string title_of_object(const Scene& scene, const std::string& name);

/// What an error (Unreadable) of a reader of meshes or caches says about such an object.
std::string unreadable_mesh(const Error& error, const std::string& title);

}  // namespace pliant
