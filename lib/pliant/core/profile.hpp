#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace pliant {

/// The parts of a run whose time is measured, in the order of a frame.
enum class Stage {
  Sampling,     ///< channels at the frame
  Selection,    ///< boxes around the nodes, the nodes that forces select, checks for finite numbers
  Load,         ///< of the forces on the nodes
  StateIn,      ///< displacement and velocity passed to the plate
  SetUp,        ///< of the solver, for other coefficients or another region
  Solve,        ///< transforms and steps
  StateOut,     ///< new positions and velocities, and whether they are finite
  Checkpoints,  ///< states that are kept for later
  Output,       ///< positions in the order of the mesh, in the requested space, and their peak
  Writing,      ///< into files
};
inline constexpr std::size_t stage_count = 10;

constexpr std::string_view name_of(Stage stage) {
  constexpr std::array<std::string_view, stage_count> names = {
      "sampling", "selection", "load",        "state in", "set-up",
      "solve",    "state out", "checkpoints", "output",   "writing"};
  return names[static_cast<std::size_t>(stage)];
}

/// How long a run spent in each stage, summed over the work that ran at the same time. [s]
struct Profile {
  std::array<double, stage_count> seconds = {};

  double& operator[](Stage stage) { return seconds[static_cast<std::size_t>(stage)]; }
  double operator[](Stage stage) const { return seconds[static_cast<std::size_t>(stage)]; }

  void add(const Profile& other) {
    for (std::size_t k = 0; k < stage_count; ++k) seconds[k] += other.seconds[k];
  }
  double total() const {
    double sum = 0;
    for (const double part : seconds) sum += part;
    return sum;
  }
};

}  // namespace pliant
