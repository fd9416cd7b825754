// Records what a scene does, and checks later that it still does the same, bit for bit: a test for
// a pipeline that upgrades its compiler, its libraries or pliant.
// usage: 5_record_and_verify SCENE.xml LOG.replay

#include <cstdio>

#include <pliant/pliant.hpp>

#include "tell.hpp"

int main(int count, char* arguments[]) {
  if (count != 3) {
    std::fprintf(stderr, "usage: 5_record_and_verify SCENE.xml LOG.replay\n");
    return 2;
  }
  // Whole states at every tenth frame, hashes at the others.
  const auto header = pliant::record_replay(arguments[1], arguments[2], {.states_every = 10});
  if (!header) return tell(header.error());
  std::printf("recorded frames %d to %d with pliant %s\n", header->start, header->end,
              header->version.c_str());

  // The log has the scene's text and the hashes of its meshes; threads do not change the bits.
  const auto verdict = pliant::verify_replay(arguments[2], {}, {.simulation = {.threads = 2}});
  if (!verdict) return tell(verdict.error());
  for (const std::string& line : verdict->lines()) std::printf("%s\n", line.c_str());
  std::printf("%ld frames %s\n", verdict->frame_count, verdict->holds() ? "hold" : "differ");
  return verdict->holds() ? 0 : 1;
}
