#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/feedback/frame_report.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/simulation/simulation.hpp"
#include "viewer/arrays.hpp"
#include "viewer/json.hpp"

namespace pliant::viewer {

/// A surface at rest as a page draws it: its nodes, faces and edges, and its positions less their
/// `origin`, in `arrays`; docs/viewer.md has the members. Errors: Interrupted.
Result<Json> shape_json(const RestShape& shape, Arrays& arrays,
                        const StopRequest& should_stop = {});

/// The vertices of the nodes that colliders push, ascending. `node_vertices`: those of the shape.
std::vector<std::uint32_t> touching_vertices(std::span<const ContactFacts> contacts,
                                             const std::vector<int>& node_vertices);

/// The notes of a scene and the warnings of its frames so far: an array of {kind, line, text,
/// file}, the last one if it is not the scene's own.
Json messages_of(const Simulation& simulation);

}  // namespace pliant::viewer
