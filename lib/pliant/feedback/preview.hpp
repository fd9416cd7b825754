#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "pliant/core/grid.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/swing.hpp"
#include "pliant/region/selection.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// The response of one region alone to a load that is applied and then constant.
struct RegionPreview {
  Region region;                  ///< in nodes
  CutCounts counts = {};          ///< of a patch of a surface of triangles, in place of `region`
  bool is_solvable = false;       ///< whether any of its nodes can move
  double static_peak = 0;         ///< as in `Preview`
  double first_frequency = 0;     ///< of its slowest vibration, undamped [Hz]; 0 without density
  double damping_ratio = 0;       ///< of that vibration [1]; < 1: it rings; 0 without density
  Swing animated;                 ///< the vibration that the load excites most, as the animation
                                  ///< shows it: including what its steps damp
  Settling settling;              ///< to 5 % at the node of the static peak, as the animation shows
                                  ///< it
  bool is_held = true;            ///< false: then only frequencies and ratios are known, of its
                                  ///< slowest vibration
  bool has_vibration = false;     ///< false: too many nodes, or none that moves; then the values of
                                  ///< vibrations are 0
  std::size_t solver_memory = 0;  ///< of the solver that found the vibrations [bytes]
};

/// The share of one of several forces in their peak.
struct ForceShare {
  std::size_t force = 0;  ///< index in the scene
  double share = 0;       ///< of the static displacement at the node of the peak, along it [1]; the
                          ///< sum is 1 if only forces move the surface
};

/// The largest displacement of an animation, world [length], and its first frame.
struct PlayedPeak {
  double peak = 0;
  int frame = 0;
};

/// The distance of a force or group that selects nothing, at the frame at which it is nearest to
/// the surface.
struct Gap {
  int frame = 0;
  double to_vertex = 0;           ///< to the nearest vertex at rest, world [length]
  double to_centre = 0;           ///< to the middle of the surface's bounding box, world [length]
  double deformation_radius = 0;  ///< must be larger than `to_vertex` to select a node
};

/// The effect of some forces on one surface at rest, so that an author can choose magnitudes and
/// densities.
struct Preview {
  enum class Of {
    Force,  ///< one force alone, with the region of its group; without the surface's tangents
    Group,  ///< the forces of a group together; without the surface's tangents
    All,    ///< all forces on the surface, with its tangents, as in the scene
  };
  std::size_t surface = 0;  ///< index in the scene
  Of of = Of::Force;
  std::size_t index = 0;  ///< of the force or the group in the scene

  double largest_magnitude = 0;     ///< of a force: the one of largest absolute value while it is
                                    ///< enabled
  int largest_magnitude_frame = 0;  ///< the first frame that has it

  /// The frame of greatest effect, with the largest static peak; the first of several. Null: no
  /// node is selected at any frame, and the following members are 0.
  std::optional<int> frame;
  bool is_every_frame = true;  ///< whether all frames were examined; false: the range is too long
  double magnitude = 0;        ///< of a force, at that frame [length b/uv^4]
  Box selected;                ///< nodes, the box around all regions; empty on a surface
  CutCounts counts = {};       ///< on a surface of triangles: of all patches
  bool is_apart = false;       ///< for `All`: boxes that do not all meet form one region, since
                               ///< `combine` is box by default, not given in the scene
  bool is_solvable = false;    ///< whether any node can move
  bool is_held = true;         ///< false: nothing holds a closed surface, which has no static state
  bool is_solved = false;  ///< false also with too many nodes for a preview, or if nothing holds
                           ///< it; then the following members are 0
  double static_peak = 0;  ///< largest displacement at rest under the load of that frame, world
                           ///< [length]
  std::vector<RegionPreview> regions;  ///< in the order given by `combine`
  std::vector<ForceShare> shares;      ///< for `Group` and `All`: in the order of the scene

  std::optional<PlayedPeak> played;  ///< in the whole animation; null: it was not played, which is
                                     ///< too costly, not needed, or looks for a cycle
  std::optional<Gap> gap;            ///< of a force or group that selects nothing
};

/// A preview does not solve regions with more moving nodes than this.
inline constexpr int most_previewed_unknowns = 200'000;

/// A preview does not find the vibrations of larger patches of surfaces of triangles, and of larger
/// patches whose outline is not a rectangle: they need a sparse factor. [moving nodes]
inline constexpr int most_vibrating_nodes = 50'000;

/// For every enabled surface of a scene with these rest shapes, in this order: each force that
/// targets it and is enabled at some frame, each such group, then all together, if anything acts.
///
/// Cost: the search for the frames of greatest effect examines about 10^8 nodes in all; for longer
/// ranges at evenly spaced frames. Animations are played, those of all forces first, until about
/// 10^8 nodes were stepped. A few seconds each. With a shelf no matrix is factored twice. Errors:
/// those of the solvers; NotFinite if a custom force returns an invalid value or a state is not
/// finite; Interrupted.
Result<std::vector<Preview>> preview_forces(const Scene& scene,
                                            std::span<const RestShape> rest_shapes,
                                            const RunContext& context = {});

/// The preview of all forces on one surface together, of whose vibrations only the slowest is
/// found, without shares and without the animation. Null: nothing acts. Cost: that of the static
/// states and of one vibration for each region. Errors: as `preview_forces`.
Result<std::optional<Preview>> preview_slowest(const Scene& scene, const RestShape& shape,
                                               std::size_t surface, const RunContext& context = {});

/// The largest displacement of a surface in the whole animation, or one that is larger than `until`
/// as soon as there is one. Cost: that of solving its frames. Errors: as `preview_forces`;
/// SolverFailed if a loop closes to no cycle.
Result<PlayedPeak> play_forces(const Scene& scene, const RestShape& shape, std::size_t surface,
                               double until, const RunContext& context = {});

}  // namespace pliant
