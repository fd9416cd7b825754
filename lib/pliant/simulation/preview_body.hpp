#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "pliant/body/body.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/preview.hpp"
#include "pliant/simulation/sampling.hpp"

namespace pliant {

// A body to try forces on, for `preview_forces`; not for other rooms. It is the engine's own, so
// that a preview and a bake agree. *Plain* means: elastic about its rest shape and without
// tangents, so that nothing but forces moves it.
class PreviewBody {
 public:
  /// Mapping, settings and memory outlive it.
  PreviewBody(const GridMapping& mapping, const SolverSettings& settings, StopRequest should_stop,
              MemoryBudget& memory);

  /// Makes it, if it is not there yet. Errors: OutOfMemory.
  Result<void> reserve();

  int node_count() const { return mapping_.grid.node_count(); }
  const std::shared_ptr<ForceFaults>& faults() const { return faults_; }

  /// What custom forces answered so far must be sound. Errors: NotFinite.
  Result<void> check_faults() const;

  /// What a step from rest would solve.
  Result<StepReport> look(const BodyInputs& inputs, bool is_plain);

  /// Brings it to rest under what acts, from its rest shape: the same step without density and
  /// damping.
  Result<void> settle(BodyInputs inputs, bool is_plain);

  /// Starts an animation at rest.
  void begin(bool is_plain);

  /// About what a frame costs at least, in steps of nodes.
  double least_cost() const { return node_count() + 5000.0; }

  /// Moves it on by a frame. Gives what that took, in steps of nodes.
  Result<double> step(BodyInputs inputs);

  struct Peak {
    double size = 0;           ///< world [length]
    Vector3d way = {0, 0, 0};  ///< world [length]
    int node = 0;
  };

  /// The largest displacement as it stands; that of a box where there is one.
  Peak peak(const Transform& transform, const std::optional<Box>& box = {}) const;
  Vector3d displacement(const Transform& transform, int node) const;  ///< world [length]

  /// From the force to the nearest node at rest and to the middle of their bounding box, in world
  /// space. [length]
  std::pair<double, double> distances(const BodyInputs& inputs, const SampledForce& force) const;

  /// How a region that is settled would vibrate when it is let go: that of its patches that has the
  /// peak. Requires: it is settled under `inputs`; there are patches.
  Result<RegionPreview> vibrations(const BodyInputs& inputs, std::span<const Patch> patches,
                                   RegionPreview region) const;

 private:
  Body& body(bool is_plain) { return is_plain && plain_ ? *plain_ : *real_; }
  Body make(Reference reference) const;
  Field displacements(const Box& box) const;

  const GridMapping& mapping_;
  const SolverSettings& settings_;
  StopRequest should_stop_;
  MemoryBudget& memory_;
  MemoryShare share_;
  std::optional<Body> real_;   // as the scene has it
  std::optional<Body> plain_;  // where that is not elastic about its rest shape
  const Body* current_ = nullptr;
  bool is_plain_ = true;     // the animation
  bool is_at_rest_ = false;  // nothing has moved yet
  StepReport report_;
  std::shared_ptr<ForceFaults> faults_ = std::make_shared<ForceFaults>();
};

}  // namespace pliant
