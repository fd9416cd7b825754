#include "pliant/forces/falloff.hpp"

#include <algorithm>

#include "pliant/core/elementary.hpp"

namespace pliant {

double falloff(Falloff kind, double s) {
  fade(kind, 1, 1, {&s, 1});
  return s;
}

void fade(Falloff kind, double magnitude, double radius, std::span<double> distances) {
  const auto replace = [&](const auto& factor) {
    for (double& each : distances) each = magnitude * factor(each / radius);
  };
  switch (kind) {
    case Falloff::Constant:
      return replace([](double) { return 1.0; });
    case Falloff::Linear:
      return replace([](double s) { return std::max(0.0, 1 - s); });
    case Falloff::Smooth:
      return replace([](double s) {
        const double x = std::clamp(1 - s, 0.0, 1.0);
        return x * x * (3 - 2 * x);
      });
    case Falloff::Gaussian:
      return replace([](double s) { return exp_of(-4.5 * s * s); });
  }
}

}  // namespace pliant
