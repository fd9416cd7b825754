#pragma once

#include <cstdint>
#include <vector>

#include "pliant/core/edges.hpp"
#include "pliant/mesh/mesh_reading.hpp"
#include "pliant/plate/time_steps.hpp"
#include "pliant/region/combine.hpp"

namespace pliant {

/// The position from which the displacement w of the plate equation is measured. SPEC 2.
enum class Reference {
  Rest,  ///< w = r - R: without forces the body converges to its rest shape R
  None,  ///< w = r: the equation as in the thesis, which smooths away relief inside the region
};

/// The mesh on which the forces' distances, and so their falloff and direction, are measured. SPEC
/// 5.
enum class Measure {
  Current,  ///< on the current mesh
  Rest,     ///< on the rest mesh, for forces that push their own nodes out of reach
};

/// The behaviour of nodes that leave the region. SPEC 6.
enum class Release {
  Freeze,   ///< they stay in place, as in the thesis
  Recover,  ///< they are solved until they are back at rest
};

/// A number other than 0 for each node that is meant (#nodes).
using NodeMarks = std::vector<std::uint8_t>;

/// What of a body is solved.
enum class SolvedRegion {
  Forces,  ///< the regions that the forces select
  All,     ///< the whole body, in each frame
};

/// The choices of a body that do not change over time.
struct BodySettings {
  Integrator integrator = Integrator::BackwardEuler;
  Stepping stepping = Stepping::Exact;
  Reference reference = Reference::Rest;
  Measure measure = Measure::Current;
  SolvedRegion region = SolvedRegion::Forces;
  Combine combine = Combine::Box;
  Release release = Release::Freeze;
  Border border = Border::Clamped;  ///< of a surface of triangles
  Edges edges = {};                 ///< of a grid that is solved as a whole
  bool is_animated = false;         ///< its rest shape moves: its state holds displacements from it
  bool yields = false;  ///< it has plastic curvatures, with Reference::Rest, not exactly
  int exact_parts = 1;  ///< of each step that `Integrator::Exact` chooses, >= 1
};

}  // namespace pliant
