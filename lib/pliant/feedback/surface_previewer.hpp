#pragma once

#include <optional>
#include <vector>

#include "pliant/feedback/acting_forces.hpp"
#include "pliant/feedback/preview.hpp"
#include "pliant/feedback/preview_body.hpp"
#include "pliant/feedback/region_motion.hpp"

namespace pliant {

// Internal to feedback.

/// Nodes that the search for frames of greatest effect examines, in all.
inline constexpr double searched_nodes = 1.5e8;
/// Steps of nodes that animations are played for, in all.
inline constexpr double played_nodes = 3e8;

/// A preview under construction, with its forces.
struct PreviewCase {
  Preview preview;
  ActingForces acting;
  std::vector<std::optional<RegionMotion>> motions = {};  ///< of `preview.regions`
};

/// The cases of a surface, in the order of `preview_forces`.
std::vector<PreviewCase> cases_of(const Scene& scene, const RestShape& shape, std::size_t index);

/// Whether the case acts at some frame.
bool has_frames(const PreviewCase& one, const Scene& scene);

/// Makes the previews of one surface.
class SurfacePreviewer {
 public:
  /// Requires: scene, surface and rest shape outlive it. Between its calls the channels of
  /// magnitude, density and damping may change.
  SurfacePreviewer(const Scene& scene, const Surface& surface, const RestShape& rest_shape,
                   double most_searched, const RunContext& context);

  /// Finds the frame of greatest effect, and fills in the results at it. Requires: a new case.
  Result<void> look(PreviewCase& one);

  /// Plays the case, unless it is a loop or that needs more steps of nodes than `nodes_left`.
  Result<void> play(PreviewCase& one, double& nodes_left);

 private:
  BodyInputs inputs_of(const PreviewCase& one, int frame);
  std::vector<int> frames_of(PreviewCase& one);
  Result<void> look_at(PreviewCase& one, int frame);
  Result<void> tell(PreviewCase& one);
  Result<void> share(PreviewCase& one, const BodyInputs& inputs, int unknowns);
  tl::unexpected<Error> located(Error error, int frame) const;

  const Scene& scene_;
  const Surface& surface_;
  PreviewBody body_;
  int first_, last_;  // frames whose solve affects the animation
  double most_frames_;
};

}  // namespace pliant
