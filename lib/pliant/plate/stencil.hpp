#pragma once

#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

/// b/hu^4, c/(hu^2 hv^2) and d/hv^4: the stiffness including the divisors of the differences along
/// u and v. docs/model.md, eq. (4) and (5).
Stiffness scaled_stiffness(const Grid& grid, const Stiffness& stiffness);

/// L w = b w_uuuu + c w_uuvv + d w_vvvv at the interior nodes (#unknowns x 3) of a field w on all
/// nodes (#nodes x 3), by second-order central differences on the 13-point stencil. The ghost nodes
/// outside the rim represent the tangents. Thesis 4.3; SPEC 4; docs/model.md, eq. (4) to (7).
/// Requires: at least 3 x 3 nodes.
Field apply_stencil(const Grid& grid, const Stiffness& stiffness, const EdgeTangents& tangents,
                    const Field& w);

}  // namespace pliant
