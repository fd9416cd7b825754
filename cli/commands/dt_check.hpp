#pragma once

#include <span>
#include <string>
#include <utility>

#include "pliant/simulation/simulation.hpp"

namespace pliant::cli {

/// Runs a scene beside a bake, with half the time step, and tells how much that changes.
class DtCheck {
 public:
  /// `options` are those of the bake.
  static Result<DtCheck> make(const Scene& scene, SimulationOptions options);

  /// Advances to the bake's frame. Requires: frames come in order, from the scene's start.
  Result<void> advance(const Frame& frame);

  /// Compares the positions of these surfaces, by their index in the scene.
  void compare(const Frame& frame, std::span<const std::size_t> surfaces);

  /// "at half the time step positions differ by 0.0123 of the peak displacement at most, …".
  std::string to_text(double peak_displacement) const;

 private:
  explicit DtCheck(Simulation simulation) : simulation_(std::move(simulation)) {}

  Simulation simulation_;
  Frame frame_;
  double difference_ = 0;  // largest distance of a vertex [length]
  int at_ = 0;             // its frame
};

}  // namespace pliant::cli
