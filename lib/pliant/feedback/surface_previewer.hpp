#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/feedback/acting_forces.hpp"
#include "pliant/feedback/preview.hpp"
#include "pliant/feedback/preview_body.hpp"
#include "pliant/feedback/region_motion.hpp"

namespace pliant {

// Internal to feedback.

/// Nodes that the search for frames of greatest effect examines, in all.
inline constexpr double searched_nodes = 1.5e8;
/// Steps of nodes that the animations of a scene's previews are played for, in all.
inline constexpr double played_nodes = 3e8;

/// A preview under construction, with its forces.
struct PreviewCase {
  Preview preview;
  ActingForces acting;
  std::vector<std::optional<RegionMotion>> motions = {};  ///< of `preview.regions`
  std::string open_cycle = {};  ///< why it was not played: its motion closes to no cycle
};

/// The cases of a surface, in the order of `preview_forces`.
std::vector<PreviewCase> cases_of(const Scene& scene, const RestShape& shape, std::size_t index);

/// The case of all forces among those of a surface; null: nothing acts.
PreviewCase* find_together(std::vector<PreviewCase>& cases);

/// Whether the case acts at some frame.
bool has_frames(const PreviewCase& one, const Scene& scene);

/// How much of a preview is made.
enum class PreviewDepth {
  Slowest,  ///< of vibrations the slowest only, so that a region does not settle, and no shares
  Whole,
};

/// Makes the previews of one surface.
class SurfacePreviewer {
 public:
  /// Requires: scene, surface and rest shape outlive it. Between its calls the channels of
  /// magnitude, density and damping may change.
  SurfacePreviewer(const Scene& scene, const Surface& surface, const RestShape& rest_shape,
                   double most_searched, const RunContext& context,
                   PreviewDepth depth = PreviewDepth::Whole);

  /// Finds the frame of greatest effect, and fills in the results at it. Requires: a new case.
  Result<void> look(PreviewCase& one);

  /// The same for a case of which `before` was looked at, with other density and damping, and with
  /// magnitudes that are those of `before` times one factor > 0: at the same frame, with the same
  /// shapes of vibrations if the effect is in proportion. Requires: a new case.
  Result<void> look_again(PreviewCase& one, const PreviewCase& before);

  /// Plays the case, unless that needs more steps of nodes than `nodes_left`. A loop is played from
  /// the beginning of its cycle on; if it has none, `open_cycle` tells. `until`: a peak beyond
  /// which it need not be played on.
  Result<void> play(PreviewCase& one, double& nodes_left,
                    double until = std::numeric_limits<double>::infinity());

  /// Whether the displacement of a static surface is the magnitudes' times a factor if they are.
  bool answers_in_proportion(const PreviewCase& one) const;

  /// Whether the whole animation is: no force pushes other nodes because it moves the surface, and
  /// no collider stops any.
  bool plays_in_proportion(const PreviewCase& one) const;

  /// Whether colliders may stop the surface. They do where it is played, and nowhere else.
  bool meets_colliders() const { return !colliders_.empty(); }

  /// Whether a peak is so small that rounding of positions hides it.
  bool is_hidden_by_rounding(double peak) const;

 private:
  // A frame under whose loads a surface of triangles was settled.
  struct Settled {
    Settled(const BodyInputs& inputs, const TriangleSelection& selection, double size)
        : stiffness(inputs.stiffness),
          poisson(inputs.poisson),
          goal(inputs.goal),
          linear(inputs.transform.linear),
          level_set(selection.level_set),
          loads(selection.loads),
          peak(size) {}

    Stiffness stiffness;
    double poisson;
    double goal;
    Matrix3d linear;
    LevelSet level_set;
    std::vector<Field> loads;
    double peak;
  };

  BodyInputs inputs_of(const PreviewCase& one, int frame);
  BodyInputs played_inputs_of(const PreviewCase& one, int frame);
  std::vector<int> frames_of(PreviewCase& one);
  std::vector<int> strongest_of(const PreviewCase& one, const std::vector<int>& frames) const;
  Result<void> look_at(PreviewCase& one, int frame);
  std::optional<double> peak_in_proportion(const BodyInputs& inputs, const StepPlan& step) const;
  Result<void> tell(PreviewCase& one, const PreviewCase* before = nullptr);
  Result<void> share(PreviewCase& one, const BodyInputs& inputs, const StepPlan& step);
  Result<std::optional<PlayedPeak>> play_response(PreviewCase& one);
  Result<bool> begin_cycle(PreviewCase& one);
  tl::unexpected<Error> located(Error error, int frame) const;
  void report(std::string_view work, int done, int count) const;

  const Scene& scene_;
  const Surface& surface_;
  const RestShape& shape_;
  PreviewDepth depth_;
  ProgressReport progressed_;
  PreviewBody body_;
  std::optional<Settled> settled_;      // the last one
  int first_, last_;                    // frames whose solve affects the animation
  std::vector<std::size_t> colliders_;  // that may stop the surface
  double most_frames_;
};

}  // namespace pliant
