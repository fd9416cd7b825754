#pragma once

#include "pliant/sampling/rest_shape.hpp"

namespace pliant {

/// As `make_rest_shape`, but a copy of the shape of the same surface if the context's shelf has it,
/// so that simulations which share a shelf read a mesh, and find its grid, once. Otherwise, and if
/// a file of it has changed since, the new one is kept there. Errors: as there.
Result<ReservedShape> find_rest_shape(const Surface& surface, const SceneOrigin& origin,
                                      const RunContext& context);

/// The same for `bind_to_driver`. Errors: as there.
Result<void> find_binding(ReservedShape& driven, const Surface& own, const RestShape& driver,
                          const Surface& driving, const Scene& scene, const RunContext& context);

}  // namespace pliant
