#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pliant/core/grid.hpp"
#include "pliant/core/result.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {

/// What one force would do to one surface: alone but for the region of the group that it is in, on
/// the surface at rest, its tangents 0, so that an author can choose magnitudes and densities
/// without running the scene.
struct ForcePreview {
  std::size_t surface = 0;   ///< index in the scene
  std::size_t force = 0;     ///< index in the scene
  double magnitude = 0;      ///< the largest one in size while it is enabled [length b/uv^4]
  int magnitude_frame = 0;   ///< the first frame that has it
  std::optional<int> frame;  ///< the first at which it is enabled and selects a node of the
                             ///< surface; what follows is as of this frame, and 0 without one
  Box region;                ///< nodes that it, or the group, selects
  bool is_solvable = false;  ///< at least 3 x 3 nodes
  bool is_solved = false;    ///< and not so many that a preview would take long; else what follows
                             ///< is 0
  double static_peak = 0;  ///< largest displacement once settled under `magnitude`, world [length]
  double frequency = 0;    ///< of the region's slowest vibration, undamped [Hz]; 0 without density
  double damping_ratio = 0;       ///< of that vibration [1]: below 1 it rings; 0 without density
  std::size_t solver_memory = 0;  ///< of the region's solver [bytes]
};

/// Regions of more unknowns than this are not solved by a preview.
inline constexpr int most_previewed_unknowns = 200'000;

/// For every enabled surface, each force that targets it and is enabled at some frame; in the order
/// of surfaces, then of forces. The search for a frame at which a force selects something ends
/// after some 10^9 distances, a few seconds. Errors: those of the solvers; NotFinite where a custom
/// force gives no sound answer; Interrupted.
Result<std::vector<ForcePreview>> preview_forces(const Simulation& simulation,
                                                 const SimulationOptions& options = {});

}  // namespace pliant
