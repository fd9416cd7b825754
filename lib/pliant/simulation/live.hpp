#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {

/// Options of a live run.
struct LiveOptions {
  /// Kept states, the store and the profile are not used: a live run only goes forward.
  SimulationOptions simulation = {};

  /// Whether the values set are recorded for `performance`: 32 bytes for each.
  bool records = false;
};

/// A scene that a program plays live: it sets channels, advances by one frame and reads positions,
/// as games, installations and editors do. There is no last frame: after the scene's, curves go on
/// as they do beyond their keys.
///
/// Each frame has the bits of the scene that has the same values as keys: `performance`. A value
/// set at a frame holds from this frame on, so the solve that leads to the next frame uses it. A
/// transform set at a frame is that of the next frame: the surface gets there while the frame is
/// solved, so that its inertia is known. The rate of a noise counts as keyed, also if nothing sets
/// it. May be used by one thread at a time.
class LiveSimulation {
 public:
  /// The scene at its first frame, at rest or after the preroll, which it plays. Errors: as
  /// `Simulation::make`, and of the preroll as `Simulation::at`; InvalidInput for a surface with a
  /// loop, which a live run cannot know, and for the rate of a noise beyond 1e150.
  static Result<LiveSimulation> make(Scene scene, const LiveOptions& options = {});

  /// The scene at the frame of a state of it, made by `Simulation::state_bytes`: to record from
  /// any frame on what was played up to it. `performance` begins at the scene's start all the same.
  /// The rate of a noise that has no keys is not keyed, and cannot be set. Errors: those of `make`
  /// and of `Simulation::restore`.
  static Result<LiveSimulation> from_state(Scene scene, std::string_view state_bytes,
                                           const LiveOptions& options = {});

  LiveSimulation(LiveSimulation&&) noexcept;
  LiveSimulation& operator=(LiveSimulation&&) noexcept;
  ~LiveSimulation();

  /// The present frame.
  int frame() const;

  /// Sets a channel by its path, as in `channels_of`: `poke.magnitude`, `poke.center`. `value` has
  /// as many numbers as the channel; of a switch, 0 is off and 1 is on. It replaces the channel's
  /// curve, if it has one. Errors, with nothing changed: InvalidInput for an unknown channel, with
  /// the nearest name, another count of numbers, and a number that is out of range or beyond 1e150;
  /// after a preroll, the rate of a noise at the first frame; from a state, one without keys.
  Result<void> set(std::string_view channel, std::span<const double> value);
  Result<void> set(std::string_view channel, double value);
  Result<void> set(std::string_view channel, const Value<3>& value);

  /// Solves the present frame and goes on to the next one. Errors, with nothing changed but what
  /// was set: those of `Simulation::at`; InvalidInput if channels break a rule together, such as c
  /// > -2 sqrt(b d), if a transform of the next frame cannot be inverted, or if a recorded scene
  /// would have too many frames. Cost: one frame, and with several surfaces or a custom force a
  /// copy of their states.
  Result<void> advance();

  /// The surfaces at the present frame; reuses the memory of `reuse`. Errors: NotFinite.
  Result<Frame> positions(Frame reuse = {});

  /// The solve that `advance` would make now: regions, forces, steps. Errors: as `advance`.
  Result<FrameReport> report();

  /// A force of the scene as it is in the world at the present frame, as `Simulation::in_world`.
  Force in_world(const Force& force) const;

  /// The scene with everything set so far as keys, from its start to the present frame. A
  /// `Simulation` of it has the same bits at each frame, and `to_xml` writes it. Requires:
  /// `LiveOptions::records`. Errors: InvalidInput if a
  /// value at the present frame breaks a rule, or for a constant beyond 1e150, which no key can
  /// have.
  Result<Scene> performance() const;

  /// The warnings of the frames played so far, as `Simulation::warnings`, but for those about what
  /// a program may set later: keys, places, radii, and surfaces that nothing moves.
  std::vector<Warning> warnings() const;

  /// The scene with the present values.
  const Scene& scene() const;

  /// The surfaces at rest, in the order of the scene.
  std::span<const RestShape> rest_shapes() const;

 private:
  class Run;

  explicit LiveSimulation(std::unique_ptr<Run> run);

  std::unique_ptr<Run> run_;  // null once moved from
};

}  // namespace pliant
