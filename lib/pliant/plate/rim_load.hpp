#pragma once

#include "pliant/plate/domain.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

/// Subtracts the contribution of rim and tangents to L w from a load (#nodes x 3): L of the field
/// that is w on the rim and 0 inside. Only the two outer layers of interior nodes change. The
/// numbers are those of `apply_stencil`. docs/model.md, eq. (6). Requires: at least 3 x 3 nodes.
void subtract_rim(const Grid& grid, const Stiffness& stiffness, const EdgeTangents& tangents,
                  const Field& w, Field& load);

/// The same for any outline, eq. (12): only the rows of interior nodes within two steps of the rim
/// change. Requires: a mask.
void subtract_rim(const Grid& grid, const InteriorMask& interior, const Stiffness& stiffness,
                  const EdgeTangents& tangents, const Field& w, Field& load);

}  // namespace pliant
