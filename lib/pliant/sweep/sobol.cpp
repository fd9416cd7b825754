#include "pliant/sweep/sobol.hpp"

#include <cmath>

#include <boost/random/sobol.hpp>

#include "pliant/core/expects.hpp"

namespace pliant {

std::vector<double> sobol_points(std::size_t dimensions, std::uint64_t first, std::size_t count) {
  PLIANT_EXPECTS(dimensions >= 1 && dimensions <= most_intervals);
  // The engine's own first point is not 0.
  boost::random::sobol engine(dimensions);
  engine.seed(first);
  std::vector<double> points(dimensions * count);
  // Only the leading bits of a coordinate are set, so that it is exact in a double.
  for (double& coordinate : points) coordinate = std::ldexp(static_cast<double>(engine()), -64);
  return points;
}

}  // namespace pliant
