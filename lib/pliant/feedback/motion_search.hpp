#pragma once

#include <optional>
#include <string>

#include "pliant/feedback/region_motion.hpp"
#include "pliant/feedback/suggestion.hpp"

namespace pliant {

// Internal to feedback.

/// Why a goal cannot be reached.
struct Miss {
  Obstacle obstacle = Obstacle::None;
  std::string reason = {};
};

/// Density and damping (or damping ratio) of a material.
struct Material {
  double density = 0;
  double damping = 0;
};

/// The material with which a region moves as wanted, or the nearest that there is.
struct MaterialFound {
  Material material;
  Miss settling;
  Miss frequency;
};

/// The material, rounded to 4 digits, for a time to settle [s] and a frequency [Hz], of which one
/// is given. Without a frequency the density stays that of `now`, without a time the damping does.
/// Cheap: no system is solved. docs/model.md, eq. (42d), (42e).
MaterialFound find_material(const RegionMotion& motion, const Material& now,
                            std::optional<double> settling, std::optional<double> frequency);

}  // namespace pliant
