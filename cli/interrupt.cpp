#include "interrupt.hpp"

#include <atomic>
#include <csignal>
#include <initializer_list>

namespace pliant::cli {
namespace {

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not wait");

void note_interrupt(int) { interrupted = true; }

}  // namespace

void catch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, &note_interrupt);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool was_interrupted() { return interrupted; }

}  // namespace pliant::cli
