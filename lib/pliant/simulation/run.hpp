#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/simulation/frame_cache.hpp"
#include "pliant/simulation/frame_ranges.hpp"
#include "pliant/simulation/sampling.hpp"
#include "pliant/simulation/simulation.hpp"
#include "pliant/simulation/state_key.hpp"
#include "pliant/simulation/step_facts.hpp"
#include "pliant/simulation/warning_log.hpp"

namespace pliant {

/// The bodies of a simulation, and the frame that they are at. Its public members are those of
/// `Simulation`, which forwards to them. Internal to simulation.
class Simulation::Run {
 public:
  Run(Scene scene, const SimulationOptions& options);

  /// Reads the scene's meshes and makes a body of each. Errors: one for each mesh that fails; none
  /// if `should_stop` ends the reading.
  std::vector<Error> add_bodies();

  Result<Frame> at(int frame, Frame reuse);
  Result<FrameReport> report(int frame);
  const BodyState& state(std::size_t surface) const;
  Result<std::string> state_bytes(int frame);
  Result<int> restore(std::string_view state_bytes);

  const Scene& scene() const { return scene_; }
  std::span<const RestShape> rest_shapes() const { return rest_shapes_; }
  std::vector<Warning> warnings() const;
  std::size_t surface_memory() const;
  SolverCounts solver_counts() const;
  FrameCounts frame_counts() const { return frame_counts_; }
  Profile profile() const;

 private:
  /// A surface's step from one frame to the next; reused to avoid allocations.
  struct Stepped {
    bool is_stepped = false;  // in the present frame
    bool is_read = false;     // read from the store, not solved
    SurfaceInputs inputs;
    Result<void> outcome;  // of the last frame that was solved or read
    StepFacts facts;
  };

  void add_body(const Surface& surface, RestShape rest_shape, MemoryShare share);
  Result<void> reach(int frame);
  Result<void> go_to(int frame);
  Result<void> step();
  void step_surfaces();
  void step_surface(std::size_t index);
  void solve_surface(std::size_t index);
  bool read_surface(std::size_t index, const Hash& key);
  void write_surface(std::size_t index, const Hash& key);
  bool is_idle(const Surface& surface, int frame) const;
  Profile* profile_of(std::size_t surface);
  void rewind(int frame);
  void keep(bool is_going_back);
  std::vector<BodyState> states() const;

  const std::optional<Hash>& key(std::size_t surface, int frame);
  Hash sealing_key(std::size_t surface, int frame);
  bool has_marks(std::size_t surface) const;
  void read_latest(int frame);
  std::optional<std::vector<BodyState>> stored_states(int frame);
  Result<SurfaceReport> report_of(std::size_t surface) const;
  Error located(Error error, const Surface& surface, int frame) const;
  int start_frame(const Surface& surface) const;

  Scene scene_;
  SceneSampling sampling_;
  MemoryBudget memory_;
  ThreadPool threads_;
  std::vector<MemoryShare> shares_;  // one a surface
  std::vector<RestShape> rest_shapes_;
  std::vector<Body> bodies_;  // one a surface
  int frame_;                 // the frame of the bodies' state
  int furthest_frame_;        // computed so far
  FrameCache cache_;
  FrameStore* store_;
  std::vector<KeyChain> keys_;  // one a surface
  FrameRanges passed_;          // frames whose warnings are known
  FrameCounts frame_counts_;
  SolverChoice solver_;
  int most_lanes_;
  StopRequest should_stop_;
  WarningLog warnings_;
  std::vector<Stepped> stepped_;   // one a surface; kept for its memory
  std::vector<Profile> profiles_;  // one per surface; empty: no profiling
};

}  // namespace pliant
