#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/feedback/frame_ranges.hpp"
#include "pliant/feedback/run_watch.hpp"
#include "pliant/feedback/warning_log.hpp"
#include "pliant/sampling/sampling.hpp"
#include "pliant/simulation/bodies.hpp"
#include "pliant/simulation/simulation.hpp"
#include "pliant/states/frame_cache.hpp"
#include "pliant/states/scene_states.hpp"

namespace pliant {

/// Plays a scene's frames in any order: brings the bodies to a frame, by steps, from kept states or
/// from the store, and collects what the frames say. Its public members are those of `Simulation`,
/// which forwards to them. Internal to simulation.
class Simulation::Player {
 public:
  Player(Scene scene, const SimulationOptions& options);

  /// As `Bodies::make_all`.
  Result<void> make_bodies();

  Result<Frame> at(int frame, Frame reuse);
  Result<FrameReport> report(int frame, ReportDetail detail);
  Result<std::string> state_bytes(int frame);
  Result<int> restore(std::string_view state_bytes);

  const Scene& scene() const { return scene_; }
  const Bodies& bodies() const { return bodies_; }
  const SceneSampling& sampling() const { return sampling_; }
  std::vector<Warning> warnings() const;
  FrameCounts frame_counts() const { return frame_counts_; }

 private:
  Result<void> reach(int frame);
  Result<void> go_to(int frame);
  Result<void> step();
  void rewind(int frame);
  void keep(bool is_going_back);
  void read_latest(int frame);

  Scene scene_;
  SceneSampling sampling_;
  Bodies bodies_;
  int first_;           // the frame at which all surfaces are at rest
  int frame_;           // the frame of the bodies' state
  int furthest_frame_;  // computed so far
  FrameCache cache_;
  SceneStates states_;
  WarningLog warnings_;
  RunWatch watch_;
  FrameRanges passed_;  // frames whose warnings are known
  FrameCounts frame_counts_;
};

}  // namespace pliant
