#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/noise_clock.hpp"
#include "pliant/simulation/targets.hpp"

namespace pliant {

// From channels to the values of one frame; not for other rooms.

/// What custom forces answered that is no answer: a distance that is negative or no number, a force
/// that is not finite. The run goes on with "out of reach" and 0 in its place, to be ended by
/// whoever asked for the inputs.
class ForceFaults {
 public:
  void add(std::string message);
  std::string first() const;  ///< naming the force, the place and the answer; empty: none
  void clear();

 private:
  mutable std::mutex mutex_;
  std::string first_;
};

/// Who stands behind a sampled force: a force, or the region of a group.
struct ForceSource {
  std::string_view name;
  std::string_view kind;  ///< the scene's word for it: point, ..., group; "custom"
  std::span<const std::string> targets;
  bool selects = true;        ///< false: it is in a group, which selects
  std::string_view key = {};  ///< of a custom force
};

/// What acts on `surface` at `frame`. Refers to the scene, which must outlive it unchanged.
struct SurfaceInputs {
  BodyInputs body;  ///< its forces in the order of the scene, then the regions of groups
  std::vector<ForceSource> sources;  ///< of `body.forces`; the selector of one in a group is that
                                     ///< of the group
  std::shared_ptr<ForceFaults> faults;    ///< shared by the custom ones among the forces
  std::vector<int> group_selectors = {};  ///< kept for its memory
};

/// The time of a noise whose rate is keyed, in a scene that starts at that frame; null: of any
/// other force.
std::unique_ptr<NoiseClock> clock_of(const Force& force, int start);

/// What is the same in all frames of a scene, found once: who acts on whom, and how far the time of
/// noises with a keyed rate has come. Holds indices only, so the scene may move, but not change.
/// Safe from several threads at once.
class SceneSampling {
 public:
  explicit SceneSampling(const Scene& scene);

  const SurfaceTargets& targets(std::size_t surface) const { return targets_[surface]; }

  /// Of a noise whose rate is keyed; null: of any other force.
  NoiseClock* clock(std::size_t force) const { return clocks_[force].get(); }

 private:
  std::vector<SurfaceTargets> targets_;
  std::vector<std::unique_ptr<NoiseClock>> clocks_;  // one a force
};

/// The same without the forces.
BodyInputs sample_body(const Scene& scene, const Surface& surface, int frame);

/// What acts on a surface, by its index in the scene that `sampling` was made of. In the memory of
/// `reuse`, earlier inputs or none: nothing is allocated then but for a program's own functions.
SurfaceInputs sample_inputs(const Scene& scene, const SceneSampling& sampling, std::size_t surface,
                            int frame, SurfaceInputs reuse = {});

/// A force as it acts on `surface`; that of a group selects no region. Custom ones tell `faults`.
/// `clock` is its own; null: the time of a noise with a keyed rate is summed up anew, frame by
/// frame.
SampledForce sample_force(const Scene& scene, const Force& force, const Surface& surface, int frame,
                          const std::shared_ptr<ForceFaults>& faults, NoiseClock* clock = nullptr);

/// The region of a group.
SampledForce sample_group(const Group& group, int frame);

Transform sample_transform(const TransformChannels& channels, int frame);

/// The group that a force is in; null: none.
const Group* group_of(const Scene& scene, const Force& force);

/// Whether a force, and the group that it is in, if any, acts at a frame, on a surface. For all
/// pairs of them `SceneSampling` has looked that up.
bool is_enabled(const Force& force, const Group* group, int frame);
bool targets(const Force& force, const Group* group, const std::string& surface);

}  // namespace pliant
