#include "interrupt.hpp"

#include <csignal>
#include <initializer_list>

namespace pliant::cli {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void note_interrupt(int) { interrupted = 1; }

}  // namespace

void catch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, &note_interrupt);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool was_interrupted() { return interrupted != 0; }

}  // namespace pliant::cli
