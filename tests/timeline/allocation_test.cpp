// Evaluation does not allocate. An executable of its own, since it counts all allocations of the
// program.

#include <cstdio>

#include "pliant/timeline/curve.hpp"
#include "pliant/timeline/sampler.hpp"
#include "support/count_allocations.hpp"
#include "timeline/authoring.hpp"

int main() {
  using namespace pliant;
  testing::Whim whim(91);
  long while_evaluating = 0;
  double sum = 0;
  for (int round = 0; round < 300; ++round) {
    const Curve<1> curve = testing::make(whim.keys(12));
    const long before = testing::allocations;
    Sampler<1> sampler(curve);
    for (double t = -60; t < 200; t += 0.25) {
      sum += sampler.value(t)[0] + curve.value(t)[0] + curve.left_value(t)[0];
      sum += sampler.velocity(t)[0] + curve.velocity(t)[0] + curve.left_velocity(t)[0];
      sum += curve.range(t, t + 9).high[0];
    }
    while_evaluating += testing::allocations - before;
  }
  std::printf("%ld allocations in all, %ld while evaluating (sum %g)\n",
              testing::allocations.load(), while_evaluating, sum);
  return testing::allocations > 0 && while_evaluating == 0 ? 0 : 1;
}
