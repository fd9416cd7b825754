#pragma once

#include <span>

namespace pliant {

/// How a force decreases with s = distance / force radius. SPEC 7.
enum class Falloff {
  Constant,  ///< 1, as in the thesis
  Linear,    ///< max(0, 1-s)
  Smooth,    ///< x^2 (3 - 2x), x = clamp(1-s, 0, 1)
  Gaussian,  ///< exp(-4.5 s^2)
};

/// The factor at s [1]. Requires: s >= 0.
double falloff(Falloff kind, double s);

/// Replaces every distance by magnitude x the factor at distance / radius. Requires: distances >=
/// 0, radius > 0.
void fade(Falloff kind, double magnitude, double radius, std::span<double> distances);

}  // namespace pliant
