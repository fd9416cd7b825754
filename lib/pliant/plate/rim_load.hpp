#pragma once

#include "pliant/plate/domain.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

/// Takes what rim and tangents contribute to L w out of a load (#nodes x 3): L of the field that is
/// w on the rim and 0 inside. It reaches the two outer layers of interior nodes only. The numbers
/// are those of `apply_stencil`. docs/model.md, eq. (6). Requires: at least 3 x 3 nodes.
void subtract_rim(const Grid& grid, const Stiffness& stiffness, const EdgeTangents& tangents,
                  const Field& w, Field& load);

/// The same for any outline, eq. (12): it reaches the interior nodes within two steps of the rim.
/// Only interior rows of `load` change. Requires: a mask.
void subtract_rim(const Grid& grid, const InteriorMask& interior, const Stiffness& stiffness,
                  const EdgeTangents& tangents, const Field& w, Field& load);

}  // namespace pliant
