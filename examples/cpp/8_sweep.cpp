// Runs a scene with nine dampings, two takes at a time, and prints which one settles first.
// usage: 8_sweep SCENE.xml SURFACE

#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include <pliant/pliant.hpp>

#include "tell.hpp"

int main(int count, char* arguments[]) {
  if (count != 3) {
    std::fprintf(stderr, "usage: 8_sweep SCENE.xml SURFACE\n");
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
  std::size_t best = 0;
  int first = scene->end + 1;
  const auto done =
      sweep->run(all, {.threads = 2, .take_done = [&](const pliant::TakeOutcome& outcome) {
                         // One call at a time, in the order in which takes end. A take that failed
                         // is no reason to stop.
                         if (!outcome.measures) return pliant::Result<void>();
                         const int settle = outcome.measures->settle;
                         if (settle < first || (settle == first && outcome.take < best)) {
                           first = settle;
                           best = outcome.take;
                         }
                         return pliant::Result<void>();
                       }});
  if (!done) return tell(done.error());
  const std::string damping(takes->texts(best).front());
  std::printf("take %zu settles first, at frame %d, by damping=%s\n", best, first, damping.c_str());
}
