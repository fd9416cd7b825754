#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/body/patch_plate.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/plate/response_space.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// A frame that is played.
struct FrameToPlay {
  BodyInputs inputs;
  Transform after;  ///< object to world after its step
};

/// Plays a large surface of triangles in the space of what its loads excite, where that is less
/// work than its steps: its patches are the same in all frames, and its loads are sums of a few
/// patterns, such as those of forces that stay where they are. Peaks are right to some 1e-5. What
/// is found is kept for the next animation. Internal to feedback.
class ResponsePlayer {
 public:
  /// A patch that it plays.
  struct Patch {
    std::vector<int> nodes;  ///< of its unknowns
    std::unique_ptr<PatchPlate> plate;
    std::optional<double> lambda = {};  ///< of its slowest vibration, if that is known
    Eigen::MatrixXd patterns;           ///< #unknowns x #patterns, orthonormal
    std::optional<ResponseSpace> space = {};
    std::vector<LoadedFrame> frames = {};
    std::vector<ResponseSpace::Parts> parts = {};  ///< after each frame
  };

  /// Requires: the surface's response is in proportion to its loads; shape and surface outlive it.
  ResponsePlayer(const RestShape& shape, const Surface& surface, MemoryBudget* memory);

  /// The largest displacement of a vertex after each of the frames, the first of which begins at
  /// rest, in world space [length]; null: it cannot be told, or not with less work. `body` is of
  /// the surface; `plan` an earlier one of it, or empty, and then the last one. Errors: those of
  /// `Body::look` and of the solver.
  Result<std::optional<std::vector<double>>> peaks(const Body& body, StepPlan& plan,
                                                   std::span<const FrameToPlay> frames);

  /// Patch `k` of a plan, its load among its patterns; null: it would not be played.
  Patch* patch_of(const Body& body, const BodyInputs& inputs, const StepPlan& plan, std::size_t k);

  /// Its space, ready to be extended. Requires: it has a pattern. Errors: those of the solver.
  Result<ResponseSpace*> space_of(Patch& patch);

  double cost() const { return cost_; }  ///< of the last peaks, in steps of nodes

 private:
  bool is_for_surface() const;
  bool has_patches(const BodyInputs& inputs, const StepPlan& plan) const;
  void begin(const Body& body, const BodyInputs& inputs, const StepPlan& plan);
  Result<bool> add(const BodyInputs& inputs, const StepPlan& plan);
  bool reserve();
  static bool add_patterns(Patch& patch, const Field& load);
  Result<bool> respond(Patch& patch, int steps);

  const RestShape& shape_;
  const Surface& surface_;
  MemoryShare share_;
  LevelSet level_set_;  // of the patches
  Stiffness stiffness_;
  double poisson_ = 0, goal_ = 0;
  std::vector<Patch> patches_;
  double cost_ = 0;
};

}  // namespace pliant
