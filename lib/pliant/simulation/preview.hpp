#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pliant/core/grid.hpp"
#include "pliant/core/result.hpp"
#include "pliant/plate/swing.hpp"
#include "pliant/region/combine.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {

/// What one region would do by itself under a load that is put on and held.
struct RegionPreview {
  Region region;                  ///< in nodes
  bool is_solvable = false;       ///< whether any of its nodes moves
  double static_peak = 0;         ///< as in `Preview`
  double first_frequency = 0;     ///< of its slowest vibration, undamped [Hz]; 0 without density
  double damping_ratio = 0;       ///< of that vibration [1]: below 1 it rings; 0 without density
  Swing animated;                 ///< the vibration that the load excites most, as it will be
                                  ///< seen: with what backward Euler adds at this dt
  Settling settling;              ///< to 5 % of the node of the static peak, as it will be seen
  bool has_vibration = false;     ///< else it has too many nodes for that, or none that moves, and
                                  ///< what belongs to vibrations is 0
  std::size_t solver_memory = 0;  ///< of what found the vibrations [bytes]
};

/// What one force of several has to do with their peak.
struct ForceShare {
  std::size_t force = 0;  ///< index in the scene
  double share = 0;       ///< of the static displacement at the node of the peak, along it [1]; all
                          ///< add up to 1 where nothing but forces moves the surface
};

/// The largest displacement of an animation, world [length], and the first frame that has it.
struct PlayedPeak {
  double peak = 0;
  int frame = 0;
};

/// How far something that selects nothing is away, at the frame at which it comes nearest to it.
struct Gap {
  int frame = 0;
  double to_vertex = 0;           ///< to the nearest vertex at rest, world [length]
  double to_centre = 0;           ///< to the middle of the surface's bounding box, world [length]
  double deformation_radius = 0;  ///< what would have to be larger than `to_vertex`
};

/// What some forces would do to one surface, on the surface at rest, so that an author can choose
/// magnitudes and densities.
struct Preview {
  enum class Of {
    Force,  ///< one force alone, but for the region of its group; without the surface's tangents
    Group,  ///< the forces of a group together; without the surface's tangents
    All,    ///< all that acts on the surface, as the scene has it
  };
  std::size_t surface = 0;  ///< index in the scene
  Of of = Of::Force;
  std::size_t index = 0;  ///< of the force or the group in the scene

  double largest_magnitude = 0;     ///< of a force: the largest one in size while it is enabled
  int largest_magnitude_frame = 0;  ///< the first frame that has it

  /// The frame of greatest effect, with the largest static peak; the first of several. None: at no
  /// frame is anything selected, and what follows is 0.
  std::optional<int> frame;
  bool is_every_frame = true;  ///< whether all were looked at, or the range is too long for that
  double magnitude = 0;        ///< of a force, at that frame [length b/uv^4]
  Box selected;                ///< nodes, around all regions
  bool is_apart = false;       ///< of all: boxes that do not all meet make one region, since
                               ///< `combine` is box, and the scene does not write that out
  bool is_solvable = false;    ///< whether any node moves
  bool is_solved = false;  ///< and not so many that a preview would take long; else what follows
                           ///< is 0
  double static_peak = 0;  ///< largest displacement once settled under the load of that frame,
                           ///< world [length]
  std::vector<RegionPreview> regions;  ///< as `combine` orders them
  std::vector<ForceShare> shares;      ///< of a group and of all: in the order of the scene

  std::optional<PlayedPeak> played;  ///< what the animation will show; none: it takes too long
  std::optional<Gap> gap;            ///< of a force or group that selects nothing
};

/// Regions of more nodes that move than this are not solved by a preview.
inline constexpr int most_previewed_unknowns = 200'000;

/// For every enabled surface, each force that targets it and is enabled at some frame, each group
/// likewise, then all together, if anything acts; in this order.
///
/// Cost: the search for the frames of greatest effect looks at some 10^8 nodes in all, at frames
/// that are evenly spaced where the range has more; animations are played, those of all forces
/// first, until some 10^8 nodes were stepped. A few seconds each. Errors: those of the solvers;
/// NotFinite where a custom force gives no sound answer or a state is not finite; Interrupted.
Result<std::vector<Preview>> preview_forces(const Simulation& simulation,
                                            const SimulationOptions& options = {});

}  // namespace pliant
