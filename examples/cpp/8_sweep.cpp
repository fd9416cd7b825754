// Runs a scene with nine dampings, two takes at a time, and prints which one comes nearest to a
// peak. usage: 8_sweep SCENE.xml SURFACE PEAK

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include <pliant/pliant.hpp>

#include "tell.hpp"

int main(int count, char* arguments[]) {
  if (count != 4) {
    std::fprintf(stderr, "usage: 8_sweep SCENE.xml SURFACE PEAK\n");
    return 2;
  }
  const auto scene = pliant::load_scene(arguments[1]);
  if (!scene) return tell(scene.error());

  // As on the command line. A `table` may have what the program chose itself, a row a take.
  const std::string vary = std::string(arguments[2]) + ".damping=5:400:9:log";
  const auto takes = pliant::Takes::make({.vary = {vary}});
  if (!takes) return tell(takes.error());
  // All values are checked here, ahead of all runs.
  const auto sweep = pliant::Sweep::make({*scene}, *takes);
  if (!sweep) return tell(sweep.error());

  std::vector<std::size_t> all(takes->count());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const double wanted = std::atof(arguments[3]);
  std::vector<double> peaks(takes->count());
  const auto done =
      sweep->run(all, {.threads = 2, .take_done = [&](const pliant::TakeOutcome& outcome) {
                         // One call at a time, in the order in which takes end. A take that failed
                         // is no reason to stop.
                         peaks[outcome.take] = outcome.measures ? outcome.measures->peak : HUGE_VAL;
                         return pliant::Result<void>();
                       }});
  if (!done) return tell(done.error());
  std::size_t best = 0;
  for (const std::size_t take : all) {
    if (std::abs(peaks[take] - wanted) < std::abs(peaks[best] - wanted)) best = take;
  }
  const std::string damping(takes->texts(best).front());
  std::printf("take %zu: damping=%s gives a peak of %g\n", best, damping.c_str(), peaks[best]);
}
