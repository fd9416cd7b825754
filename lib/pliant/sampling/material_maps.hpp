#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/plate/plate_problem.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

// Maps of the material: read once, for each surface; not for programs. docs/model.md, "Maps".

/// The names of the attributes that a surface's maps and holds ask of its mesh, each once.
std::vector<std::string> attributes_of_maps(const Surface& surface);

/// An error about an attribute of a mesh, with the line of the first map or hold that asks for it.
Error about_attribute(const Surface& surface, const SceneOrigin& origin, Error error,
                      std::string_view attribute);

/// What the values of a map are, and what makes them 0 to 1, if neither they nor the factors that
/// they make are within 0 to 1; otherwise empty.
std::string outside_unit_range(const MaterialMap& map, const MapSummary& summary);

/// Reads the maps of a surface and finds their factors at the nodes of its shape, whose mesh is the
/// one that the scene names, not refined. `take` reserves that many bytes more. Errors, with the
/// map's line: a file that cannot be read; those of `parse_png` and `parse_npy_grid`; a .npy of a
/// surface that is no grid; a vertex without (u,v) under a picture; vertices of one node with other
/// values; values of a program that are not one for each vertex, or not finite; those of `take`;
/// Interrupted.
Result<NodeFactors> read_maps(const Surface& surface, const RestShape& shape,
                              const SceneOrigin& origin,
                              const std::function<Result<void>(std::size_t)>& take,
                              const StopRequest& should_stop = {});

/// Marks the nodes that a surface's holds hold, of a shape as `read_maps` takes it. Errors, with
/// the hold's line: those of `read_maps`; no node above the threshold; a vertex that is not there.
Result<NodeMarks> read_holds(const Surface& surface, const RestShape& shape,
                             const SceneOrigin& origin,
                             const std::function<Result<void>(std::size_t)>& take,
                             const StopRequest& should_stop = {});

/// Checks what maps make of the material, at every node, every triangle of a surface, and every
/// frame of the scene: density, damping, hardening and goal >= 0, b, d and yield > 0, c > -2 sqrt(b
/// d), all finite; with a map of b, c or d also |poisson| < 1 and c > 2 poisson sqrt(b d); an
/// integrator that is not backward Euler needs density at all nodes or at none; a static surface
/// that yields needs hardening at all. At most one error per channel, with the frame, the place and
/// the values. Requires: `check_channels` accepts the scene. Cost: two places a channel decide, so
/// that frames cost little.
std::vector<Error> check_maps(const Scene& scene, const Surface& surface, const RestShape& shape);

/// The same at one frame only.
std::vector<Error> check_maps_at(const Scene& scene, const Surface& surface, const RestShape& shape,
                                 int frame);

}  // namespace pliant
