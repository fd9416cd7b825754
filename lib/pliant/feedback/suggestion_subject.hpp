#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pliant/feedback/suggestion.hpp"

namespace pliant {

// Internal to feedback.

/// What acts on which surface, and what may be changed.
struct Subject {
  std::size_t surface = 0;  ///< index in the scene
  Preview::Of of = Preview::Of::All;
  std::size_t index = 0;                 ///< of the force or the group in the scene
  std::vector<std::size_t> forces = {};  ///< whose magnitudes change; not yet known
};

/// The subject that the goals name. Errors: InvalidInput if a name is unknown, or of a surface that
/// is not solved or not acted on, or if there are several.
Result<Subject> find_subject(const Scene& scene, std::span<const RestShape> rest_shapes,
                             const MotionGoals& goals);

}  // namespace pliant
