#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/document/operation.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant::editor {

/// How a surface moves under all its forces.
struct SurfaceMotion {
  std::optional<double> peak = {};       ///< the largest displacement, world [length]
  std::optional<double> settling = {};   ///< [s]
  std::optional<double> frequency = {};  ///< [Hz]
  std::string reason = {};               ///< why one of these is not known, in one line
};

/// Errors: InvalidInput: no surface has that name; those of `preview_forces`.
Result<SurfaceMotion> motion_of(Scene scene, const std::string& surface,
                                const SimulationOptions& options);

/// What gives a scene the suggested values that differ from its own.
std::vector<Operation> operations_for(const Suggestion& suggestion, const Scene& scene);

}  // namespace pliant::editor
