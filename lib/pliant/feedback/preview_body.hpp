#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/feedback/preview.hpp"
#include "pliant/feedback/region_motion.hpp"
#include "pliant/feedback/response_player.hpp"
#include "pliant/plate/vibration.hpp"
#include "pliant/sampling/sampling.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

// Internal to feedback.

/// Whether nothing but forces moves the surface: it is elastic about its rest shape, and its edges
/// are given no slope.
bool is_plain(const Surface& surface);

/// Whether a plan has no load at all. Of a grid that is not known: false.
bool has_no_load(const StepPlan& plan);

/// The regions of a plan, or its patches, without their vibrations. Internal to feedback.
std::vector<RegionPreview> regions_of(const StepPlan& plan);

/// A region with its vibrations. Internal to feedback.
struct MovingRegion {
  RegionPreview preview;
  std::optional<RegionMotion> motion = {};  ///< null: it has none
};

/// Inputs in which one force pushes, while the region is that of all of them. Internal to feedback.
class SingleForces {
 public:
  /// `selecting`: forces that together select what all do. Requires: inputs outlive it.
  SingleForces(const BodyInputs& inputs, std::vector<std::size_t> selecting);

  /// With the magnitude of force `k` only. Its forces are `selecting`, `k` and its selector.
  BodyInputs of(std::size_t k) const;

 private:
  const BodyInputs& inputs_;
  BodyInputs none_;  // without forces
  std::vector<std::size_t> selecting_;
};

// A body for trying forces, for `preview_forces`; internal to feedback. It is the engine's own
// `Body`, so that a preview and a bake agree. *Plain* means: elastic about its rest shape and
// without tangents, so that only forces move it.
class PreviewBody {
 public:
  /// `frame_seconds`: length of a frame of the scene [s]. `with_swings`: whether more is wanted of
  /// vibrations than the slowest one. Requires: shape and surface outlive it.
  PreviewBody(const RestShape& shape, const Surface& surface, double frame_seconds,
              bool with_swings, RunContext context);

  /// Makes the bodies, unless they exist. Errors: OutOfMemory.
  Result<void> reserve();

  int node_count() const { return static_cast<int>(shape_.rest.rows()); }
  const std::shared_ptr<ForceFaults>& faults() const { return faults_; }

  /// Checks that custom forces have returned only valid values so far. Errors: NotFinite.
  Result<void> check_faults() const;

  /// The plan of a step from rest, until the next call.
  Result<const StepPlan*> look(const BodyInputs& inputs, bool is_plain);

  /// Brings it to rest under the inputs, starting from its rest shape: one step without density and
  /// damping.
  Result<void> settle(BodyInputs inputs, bool is_plain);

  /// Starts an animation at rest.
  void begin(bool is_plain);

  /// A lower estimate for the cost of a frame, in steps of nodes.
  double least_cost() const { return node_count() + 5000.0; }

  /// Advances it by a frame. Returns the cost, in steps of nodes.
  Result<double> step(BodyInputs inputs);

  /// The peaks after frames from rest on, as `ResponsePlayer` finds them. Requires: the animation
  /// is in proportion to its loads.
  Result<std::optional<std::vector<double>>> response_peaks(std::span<const FrameToPlay> frames);
  double response_cost() const { return response_.cost(); }

  /// Puts the animation that begins at the beginning of its cycle, found as a run finds it.
  /// `advance` steps it over a frame of the round. Errors: those of `pliant::find_cycle`.
  Result<void> begin_cycle(int frames, const std::function<Result<void>(int frame)>& advance);

  /// Goes there again. Requires: `begin_cycle` succeeded for this animation.
  void return_to_cycle();

  struct Peak {
    double size = 0;           ///< world [length]
    Vector3d way = {0, 0, 0};  ///< world [length]
    int node = 0;
  };

  Peak peak(const Transform& transform) const;  ///< the largest present displacement
  Vector3d displacement(const Transform& transform, int node) const;  ///< world [length]

  /// The largest present displacement of a vertex, as a frame shows it. World [length]
  double shown_peak(const Transform& transform) const;

  /// From the force to the nearest node at rest and to the middle of their bounding box, in world
  /// space. [length]
  std::pair<double, double> distances(const BodyInputs& inputs, const SampledForce& force) const;

  /// Forces that together select what all of the inputs do, at rest: about as many as its nodes at
  /// most, however many there are. `plan` is of these inputs.
  std::vector<std::size_t> selecting(const BodyInputs& inputs, const StepPlan& plan) const;

  /// The vibrations of a settled region when it is released, for its patch with the peak: those of
  /// region or patch `k` of `plan`. `known`: how that moves, if only its load by a factor, density
  /// and damping are others than when it was found; null: it is found. Requires: it is settled
  /// under `inputs`; `region.is_solvable`.
  Result<MovingRegion> vibrations(const BodyInputs& inputs, const StepPlan& plan, std::size_t k,
                                  RegionPreview region, const RegionMotion* known = nullptr);

  /// The frequency of the slowest vibration and its damping ratio, of region or patch `k` of a plan
  /// that nothing holds. `known` as for `vibrations`. Requires: `region.is_solvable`; inputs with
  /// density.
  Result<MovingRegion> unheld_vibration(const BodyInputs& inputs, const StepPlan& plan,
                                        std::size_t k, RegionPreview region,
                                        const RegionMotion* known = nullptr) const;

 private:
  Body& body(bool is_plain) { return is_plain && plain_ ? *plain_ : *real_; }
  Result<std::unique_ptr<Body>> make(Reference reference) const;
  Result<void> plan(const BodyInputs& inputs, bool is_plain);
  std::vector<std::size_t> deepest_at_nodes(const BodyInputs& inputs,
                                            const LevelSet& level_set) const;
  Field displacements(std::span<const int> nodes) const;
  MovingRegion moving_as(const RegionMotion& motion, const BodyInputs& inputs,
                         RegionPreview region) const;
  void set_natural(const BodyInputs& inputs, const Dynamics& dynamics, double lambda,
                   RegionPreview& region) const;
  Result<MovingRegion> add_vibrations(const BodyInputs& inputs, const VibratingPlate& plate,
                                      double drag, const Field& ways, double least,
                                      RegionPreview region, ResponseSpace* space = nullptr) const;
  RegionMotion motion_of(const BodyInputs& inputs, std::vector<ExcitedMode> modes, double slowest,
                         double drag) const;

  const RestShape& shape_;
  const Surface& surface_;
  double frame_seconds_;
  bool with_swings_;
  RunContext context_;
  MemoryShare share_;
  std::unique_ptr<Body> real_;   // as in the scene
  std::unique_ptr<Body> plain_;  // if `real_` is not elastic about its rest shape
  StepPlan plan_;                // made last; one body alone is of triangles
  const Body* current_ = nullptr;
  bool is_plain_ = true;     // whether the animation is of the plain body
  bool is_at_rest_ = false;  // nothing has moved yet
  BodyState cycle_;          // at the beginning of the cycle
  ResponsePlayer response_;
  std::shared_ptr<ForceFaults> faults_ = std::make_shared<ForceFaults>();
};

}  // namespace pliant
