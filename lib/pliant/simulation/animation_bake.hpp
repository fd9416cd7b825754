#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/writer.hpp"
#include "pliant/sampling/drawn_collider.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/frame.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {

/// What an animation of a simulation contains, and where it goes.
struct AnimationOptions {
  std::string file;                        ///< its ending determines the format
  FrameSpan frames = {};                   ///< of the scene
  std::vector<std::size_t> surfaces = {};  ///< by their index in the scene; none: all
  bool is_world = true;  ///< false: positions in object space, placed where the format can
  bool omits_colliders = false;
  bool resume = false;  ///< keeps files of a sequence that already have the right content
  /// Of the simulation and the colliders together. [bytes]
  std::size_t max_memory = std::numeric_limits<std::size_t>::max();
  StopRequest should_stop = {};
};

/// The files of `pliant bake`, written from the frames of a simulation, first to last. They appear
/// whole or not at all: without `finish` a format of one file leaves nothing behind.
class AnimationBake {
 public:
  /// Plans the files, and writes nothing. Errors: those of `DrawnColliders::make`; Interrupted.
  /// Requires: check_ending(options.file); the simulation outlives it; the scene has the frames.
  static Result<AnimationBake> make(const Simulation& simulation, const AnimationOptions& options);

  const AnimationPlan& plan() const { return plan_; }
  const std::vector<std::size_t>& surfaces() const { return surfaces_; }  ///< by their index

  /// Checks that no file of the plan is an input of the scene: a bake to head.pc2 also writes
  /// head.obj. Errors: InvalidInput, naming the input.
  Result<void> check_inputs() const;

  /// Makes the writer. Errors: those of `make_writer`.
  Result<void> begin();

  /// Writes the chosen surfaces of the next frame. Errors: those of `AnimationWriter::write`, and
  /// of the colliders. Requires: begin.
  Result<void> write(const Frame& frame);

  /// Gives the result its name. Errors: those of `AnimationWriter::finish`. Requires: every frame
  /// of the plan has been written.
  Result<void> finish();

  FileCounts file_counts() const { return writer_->file_counts(); }  ///< of a sequence, until now
  int frame_count() const { return frame_count_; }                   ///< written until now
  long vertex_count() const;                                         ///< of the chosen surfaces
  /// Of the frames until now, as people are to be told it. [length]
  double peak_displacement() const { return peak_displacement_; }
  /// The time of copying positions (`Output`) and of the writer (`Writing`).
  const Profile& profile() const { return profile_; }

 private:
  AnimationBake(const Simulation& simulation, const AnimationOptions& options);

  const Simulation* simulation_;
  std::vector<std::size_t> surfaces_;
  bool is_world_;
  AnimationPlan plan_;
  DrawnColliders colliders_;
  std::unique_ptr<AnimationWriter> writer_;
  std::vector<SurfacePose> poses_;  // of the surfaces, reused to avoid allocations
  Profile profile_;
  int frame_count_ = 0;
  double peak_displacement_ = 0;
};

}  // namespace pliant
