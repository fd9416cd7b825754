#pragma once

#include "pliant/plate/outline/outline.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

/// Subtracts the contribution of rim and tangents to L w from a load (#nodes x 3): L of the field
/// that is w on the rim and 0 inside. Only the rows of interior nodes within two steps of the rim
/// change. The numbers are those of `Stencil`. docs/model.md, eq. (6), (12). Requires: at
/// least 3 x 3 nodes.
void subtract_rim(const Outline& outline, const Stiffness& stiffness, const EdgeTangents& tangents,
                  const Field& w, Field& load);

}  // namespace pliant
