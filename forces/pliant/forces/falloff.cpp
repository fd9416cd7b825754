#include "pliant/forces/falloff.hpp"

#include <algorithm>

#include "pliant/core/elementary.hpp"

namespace pliant {

double falloff(Falloff kind, double s) {
  switch (kind) {
    case Falloff::Constant:
      return 1;
    case Falloff::Linear:
      return std::max(0.0, 1 - s);
    case Falloff::Smooth: {
      const double x = std::clamp(1 - s, 0.0, 1.0);
      return x * x * (3 - 2 * x);
    }
    case Falloff::Gaussian:
      return exp_of(-4.5 * s * s);
  }
  return 0;
}

}  // namespace pliant
