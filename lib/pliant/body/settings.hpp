#pragma once

#include "pliant/plate/time_steps.hpp"
#include "pliant/region/combine.hpp"

namespace pliant {

/// What the displacement w of the plate equation is measured from. SPEC 2.
enum class Reference {
  Rest,  ///< w = r - R: the body converges to its rest shape R when nothing acts
  None,  ///< w = r: the equation as the thesis writes it, which smooths relief inside the region
         ///< away
};

/// Where the forces' distances, and with them falloff and direction, are measured. SPEC 5.
enum class Measure {
  Current,  ///< on the mesh as it stands
  Rest,     ///< on the rest mesh, for forces that push their own nodes out of reach
};

/// What happens to nodes that leave the region. SPEC 6.
enum class Release {
  Freeze,   ///< they stay where they are: the thesis
  Recover,  ///< they go on being solved until they are back at rest
};

/// The choices of a body that do not change over time.
struct BodySettings {
  Stepping stepping = Stepping::Exact;
  Reference reference = Reference::Rest;
  Measure measure = Measure::Current;
  Combine combine = Combine::Box;
  Release release = Release::Freeze;
};

}  // namespace pliant
